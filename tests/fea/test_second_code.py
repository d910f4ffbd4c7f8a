from fea.verification.second_code import inflated_cylinder, twisted_block


def test_twisted_block_agrees_with_felupe():
    assert twisted_block(cells=4, felupe_cells=3).error < 5e-3


def test_inflated_cylinder_agrees_with_felupe():
    row = inflated_cylinder(cells=4)
    assert row.exact > 1e-3  # a large strain: the inner radius is 10 mm
    assert row.error < 5e-3
