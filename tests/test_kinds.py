import pytest

from softhand_sim.kinds import found_kinds


def package(tmp_path, monkeypatch, name, **files):
    folder = tmp_path / name
    folder.mkdir()
    (folder / "__init__.py").touch()
    for file, text in files.items():
        (folder / f"{file}.py").write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    return found_kinds(name, [str(folder)])


def test_the_kinds_of_all_modules_are_there_in_order(tmp_path, monkeypatch):
    kinds = package(tmp_path, monkeypatch, "kinds_of_two", late='KINDS = {"a": 1}', early='KINDS = {"c": 3, "b": 2}')
    assert list(kinds.items()) == [("a", 1), ("b", 2), ("c", 3)]
    with pytest.raises(TypeError):
        kinds["d"] = 4


def test_a_kind_of_two_modules_is_refused(tmp_path, monkeypatch):
    with pytest.raises(ValueError, match=r"kinds_twice\.two: the kind 'a' is defined in another file"):
        package(tmp_path, monkeypatch, "kinds_twice", one='KINDS = {"a": 1}', two='KINDS = {"a": 2}')
