"""A study's files: VTU fields and a picture of each level, and the curve."""

from pathlib import Path

import numpy as np

from fea.fields import node_strain, von_mises_fields
from fea.pictures import draw_curves, draw_half_model
from fea.study import Study
from fea.vtu import write_vtu


def write_results(
    folder: Path, study: Study, *, unit: str, scale: float, curve: tuple[str, str], draw: bool = True
) -> list[Path]:
    """Write ``fields-000.vtu`` ... and, with ``draw``, ``deformed-000.png`` ... and ``curve.png``; return the files.

    Parameters
    ----------
    folder : Path
    study : Study
    unit, scale : str, float
        Unit of the levels in titles and its size in SI units.
    curve : (str, str)
        Key of the study's figures that is drawn over the levels, and its label.
    draw : bool
        Whether to draw pictures (needs matplotlib).
    """
    files = []
    strains = [node_strain(study.model, u) for u in study.states]
    # choice: the colours end at the 99.8th percentile of the last level, so that single corner nodes do not set them
    top = float(np.percentile(strains[-1], 99.8))
    for index, (level, u, strain) in enumerate(zip(study.levels, study.states, strains, strict=True)):
        fields = von_mises_fields(study.model, u)
        files.append(folder / f"fields-{index:03d}.vtu")
        write_vtu(
            files[-1],
            study.model.mesh,
            nodes={"displacement_m": u, "von_mises_strain": strain},
            cells={
                "von_mises_strain_mean": fields.element_strain(),
                "von_mises_stress_pa_mean": fields.element_stress_pa(),
                "material": study.model.mesh.material.astype(np.float64),
            },
        )
        if draw:
            files.append(folder / f"deformed-{index:03d}.png")
            title = f"{level / scale:g} {unit}"
            draw_half_model(files[-1], study.model.mesh, u, strain, title=title, top=top)
    if draw:
        key, label = curve
        files.append(folder / "curve.png")
        values = {label: np.array(study.figures[key])}
        draw_curves(files[-1], study.levels / scale, values, x_label=unit, y_label=label)
    return files
