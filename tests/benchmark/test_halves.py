import dataclasses

import pytest

from softhand_sim.benchmark.halves import half, held_in_halves
from softhand_sim.grasp.protocol_file import load_protocol
from softhand_sim.grasp.result import crashed
from softhand_sim.grasp.verdict import Outcome
from softhand_sim.objects.catalogue import load_catalogue, make_object


def test_halves_share_nothing_and_leave_nothing():
    names = list(load_catalogue())
    development, report = half(names, "development"), half(reversed(names), "report")
    assert sorted(development + report) == sorted(names)
    assert len(development) - len(report) in (0, 1)
    with pytest.raises(ValueError, match="half: 'both'"):
        half(names, "both")


def test_the_line_counts_each_half_and_only_of_the_whole_catalogue():
    protocol, names = load_protocol(), ["lemon", "apple", "mug"]
    lost = [crashed(make_object(name), protocol, 0) for name in names]
    results = [lost[0], dataclasses.replace(lost[1], outcome=Outcome.HELD), lost[2]]
    line = held_in_halves(results, names)
    assert line == "development half: 1 of 2 held (50%); report half: 0 of 1 held (0%)"
    assert held_in_halves(results[:2], names) == ""
