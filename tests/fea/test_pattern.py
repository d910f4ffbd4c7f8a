import numpy as np
import scipy.sparse as sp

from fea.pattern import GrowingPattern


def upper(entries: dict[tuple[int, int], float], size: int = 5) -> sp.csr_array:
    row, column = np.array(list(entries)).T
    return sp.csr_array((list(entries.values()), (row, column)), shape=(size, size))


SOLID = upper({(0, 0): 1.0, (0, 1): 2.0, (1, 1): 3.0, (2, 2): 4.0, (3, 3): 5.0, (4, 4): 6.0})


def test_sums_are_right_and_the_pattern_only_grows():
    pattern, seen = GrowingPattern(), 0
    contacts = [
        upper({(0, 3): 1.5, (1, 1): -1.0}),
        upper({(2, 4): 2.5}),
        upper({(0, 3): 7.0}),
        sp.csr_array((5, 5)),
    ]
    for contact in contacts:
        total = pattern.add(SOLID, contact)
        np.testing.assert_allclose(total.toarray(), (SOLID + contact).toarray())
        assert total.nnz >= seen
        assert total.has_sorted_indices
        seen = total.nnz
    assert seen == SOLID.nnz + 2  # (0, 3) and (2, 4); (1, 1) was there


def test_a_settled_pattern_stays_the_same():
    pattern = GrowingPattern()
    pattern.add(SOLID, upper({(0, 3): 1.0, (2, 4): 1.0}))
    one = pattern.add(SOLID, upper({(0, 3): 1.0}))
    two = pattern.add(SOLID, upper({(2, 4): 1.0}))
    np.testing.assert_array_equal(one.indices, two.indices)
    np.testing.assert_array_equal(one.indptr, two.indptr)


def test_contact_of_one_place_given_twice_adds_up():
    twice = sp.coo_array(([1.0, 2.0], ([0, 0], [3, 3])), shape=(5, 5))
    total = GrowingPattern().add(SOLID, sp.csr_array(twice))
    assert total.toarray()[0, 3] == 3.0
