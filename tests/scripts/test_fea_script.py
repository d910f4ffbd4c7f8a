"""``scripts/fea.py``: bad input is one line before any mesh is built; good input gives the agreed keys and files."""

import json
import subprocess
import sys
from pathlib import Path

import pytest
from PIL import Image

import fea
from scripts import fea as script

ROOT = Path(fea.__file__).parents[1]
COST = {"dofs", "wall_s", "newton_iterations", "assembly_s", "solve_s", "contact_s"}


@pytest.fixture
def no_mesh(monkeypatch):
    def refuse(*_):
        raise AssertionError("a mesh was built")

    monkeypatch.setattr("fea.actuator.build_mesh", refuse)
    monkeypatch.setattr("fea.exoskeleton.build_mesh", refuse)


def soft_thread(folder: Path, poisson: str) -> str:
    text = (ROOT / "assets" / "materials" / "pet.toml").read_text()
    file = folder / "thread.toml"
    file.write_text(text.replace('value = 0.417, unit = "1"', f'value = {poisson}, unit = "1"'))
    return str(file)


@pytest.mark.usefixtures("no_mesh")
@pytest.mark.parametrize(
    ("argv", "told"),
    [
        (["actuator", "--dimension", "actuator_outer_radius_m=0.0049"], "= 0.0019 m must be at least 0.002"),
        (["exoskeleton", "--dimension", "tube_wall_m=0.001"], "tube_wall_m = 0.001 m"),
        (["actuator", "--dimension", "actuator_inner_radius_m=0.006"], "chamber larger than actuator"),
        (["actuator", "--dimension", "cap_thickness_m=0.095"], "it leaves no chamber"),
        (["actuator", "--dimension", "colour=3"], "--dimension colour: no such dimension"),
        (["actuator", "--dimension", "ring_count=4.5"], "ring_count: 4.5 must be a whole number"),
        (["actuator", "--dimension", "ring_count"], "ring_count must read NAME=VALUE"),
        (["actuator", "--pressures=-120,10"], "-120000 Pa must be finite and at least -100000 Pa"),
        (["actuator", "--pressures", "20,10"], "pressures_pa_gauge = [20000.0, 10000.0] must be positive and incr"),
        (["actuator", "--pressures", "10,nan"], "pressures_pa_gauge: nan"),
        (["actuator", "--pressures", "ten"], "--pressures"),
        (["actuator", "--loads", "0.1"], "--loads: not an option of actuator"),
        (["exoskeleton", "--loads", "0.2,0.1"], "loads_n = [0.2, 0.1]"),
        (["actuator", "--silicone", "ecoflex-00-31/set3"], "no material 'ecoflex-00-31'; shipped: ecoflex-00-50"),
        (["actuator", "--silicone", "ecoflex-00-50/set9"], "sets has no 'set9'; allowed"),
        (["actuator", "--silicone", "nowhere.toml/set1"], "nowhere.toml"),
        (["exoskeleton", "--volumetric", "d1_literal"], "field 'sets.set3.d1' is missing"),
        (["actuator", "--mesh", "infinite"], "--mesh"),
        (["dance"], "dance"),
        (["actuator", "--json", "/proc/none/a.json"], "--json"),
    ],
)
def test_bad_input_is_one_line_before_meshing(argv, told, capsys):
    try:
        status = script.main(argv)
    except SystemExit as stop:  # argparse
        status = stop.code
    lines = capsys.readouterr().err.strip().splitlines()
    assert status == 2
    assert len(lines) == 1
    assert told in lines[0]


@pytest.mark.usefixtures("no_mesh")
@pytest.mark.parametrize("poisson", ["0.5", "0.6"])
def test_incompressible_linear_elastic_rings_are_refused(tmp_path, capsys, poisson):
    assert script.main(["actuator", "--thread", f"{soft_thread(tmp_path, poisson)}/paper"]) == 2
    assert f"poisson_ratio = {poisson} must lie in (-1, 0.5)" in capsys.readouterr().err


def test_exoskeleton_writes_keys_fields_and_pictures(tmp_path, capsys):
    out, file = tmp_path / "out", tmp_path / "x.json"
    argv = ["exoskeleton", "--mesh", "coarse", "--loads", "0.01", "--json", str(file), "--out", str(out)]
    assert script.main(argv) == 0
    data = json.loads(file.read_text())
    wanted = {"load_n", "tip_deflection_m", "joint_rotation_rad", "max_von_mises_stress_pa", "stress_maximum_at"}
    assert wanted | COST | {"element_quality", "status", "provenance"} <= set(data)
    assert data["load_n"] == [0.0, 0.01]
    names = {p.name for p in out.iterdir()}
    assert names == {
        "checkpoint",
        "curve.png",
        *(f"deformed-00{k}.png" for k in (0, 1)),
        *(f"fields-00{k}.vtu" for k in (0, 1)),
    }
    for name in ("deformed-001.png", "curve.png"):
        colours = Image.open(out / name).convert("RGB").getcolors(maxcolors=1 << 24)
        assert len(colours) > 50  # not an empty page
    assert "residual" in capsys.readouterr().err


def test_actuator_writes_its_keys(tmp_path):
    file = tmp_path / "a.json"
    argv = ["actuator", "--mesh", "coarse", "--no-rings", "--pressures", "0.5", "--dimension", "ring_count=8"]
    assert script.main([*argv, "--json", str(file)]) == 0
    data = json.loads(file.read_text())
    wanted = {"pressure_pa_gauge", "axial_stretch", "outer_radius_growth", "wall_thickness_m", "volume_m3"}
    assert wanted | COST | {"max_von_mises_strain", "element_quality"} <= set(data)
    assert data["pressure_pa_gauge"] == [0.0, 500.0]
    assert data["outer_radius_growth"][1] > 0.0


@pytest.mark.parametrize("name", ["fea.py", "calibrate.py", "export_stl.py"])
def test_scripts_start_by_their_path(name, tmp_path):
    """``scripts/fea.py`` has the name of the package that these scripts import."""
    done = subprocess.run(
        [sys.executable, str(ROOT / "scripts" / name), "--help"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "examples:" in done.stdout
