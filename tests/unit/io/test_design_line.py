"""Design lines as files: what they may say, and what is said of what they may not."""

import numpy as np
import pytest

from springline.errors import FormatError, InputError
from springline.io.design_line import read_design_line


def table(tmp_path, text):
    path = tmp_path / "line.csv"
    path.write_text(text)
    return path


def test_units_stand_in_the_columns_names(tmp_path):
    line = read_design_line(table(tmp_path, "Easting [ft],northing_m,axis_elevation_mm\n10,1,2000\n20,2,1990\n\n"))
    np.testing.assert_allclose(line["easting"], [3.048, 6.096])
    np.testing.assert_allclose(line["elevation"], [2.0, 1.99])
    assert line.attrs == {"refers_to": "axis", "source": "line.csv"}


def test_plain_elevations_must_say_of_what(tmp_path):
    path = table(tmp_path, "chainage_m,elevation_m\n0,1\n1,2\n")
    with pytest.raises(InputError, match="axis or of the invert"):
        read_design_line(path)
    assert read_design_line(path, of="invert").attrs["refers_to"] == "invert"
    with pytest.raises(InputError, match="'inverts' is unknown, did you mean 'invert'"):
        read_design_line(path, of="inverts")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("chainage_m,invert_elevation_m\n0,1\n1,x\n", "row 3, column invert_elevation_m: 'x' is not a number"),
        ("chainage_m,invert_elevation_m\n0,1\n1,nan\n", "row 3, column invert_elevation_m"),
        ("chainage_m,invert_elevation_m\n0,1\n1\n", "row 3, column invert_elevation_m: '' is not a number"),
        ("chainage_m,invert_elevation_m\n0,1\n0,2\n", "row 3, column chainage: the chainage does not increase"),
        ("chainage_m,invert_elevation_m\n0,1\n", "the line has 1 points"),
        ("chainage_m,invert_elevation_m\n", "the line has 0 points"),
        ("chainage,invert_elevation_m\n0,1\n1,2\n", "'chainage' states no unit"),
        ("chainage_furlong,invert_elevation_m\n0,1\n1,2\n", "unknown column 'chainage_furlong'"),
        ("chainage_m,invert_elevation_m,axis_elevation_m\n0,1,1\n1,2,2\n", "both invert_elevation and axis_elevation"),
        ("chainage_m\n0\n1\n", "no column of elevations"),
        ("invert_elevation_m\n0\n1\n", "neither a chainage nor an easting"),
        ("easting_m,invert_elevation_m\n0,1\n1,2\n", "one coordinate without the other"),
        ("chainage_m,chainage_ft,invert_elevation_m\n0,0,1\n1,3,2\n", "hold the same"),
        ("easting_m,northing_m,axis_elevation_m\n0,0,1\n0,0,2\n", "row 3, column easting: the point stands where"),
        ("distance_m,invert_elevation_m\n0,1\n1,2\n", "unknown column 'distance_m'"),
        ("", "no column of elevations"),
    ],
)
def test_faults_name_file_row_and_column(tmp_path, text, said):
    with pytest.raises(InputError) as caught:
        read_design_line(table(tmp_path, text))
    assert said in str(caught.value)
    assert "line.csv" in str(caught.value)


def test_a_missing_or_binary_file_is_refused(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        read_design_line(tmp_path / "none.csv")
    with pytest.raises(InputError, match="no such file"):
        read_design_line(tmp_path / "none.xml")
    (tmp_path / "line.csv").write_bytes(b"\xff\xfe\x00\x01")
    with pytest.raises(FormatError):
        read_design_line(tmp_path / "line.csv")


LANDXML = """<LandXML xmlns="http://www.landxml.org/schema/LandXML-1.2">
<Units><Metric linearUnit="meter"/></Units>
<Alignments><Alignment name="a" length="{length}" staStart="100">
<CoordGeom>
<Line><Start>0 0</Start><End>10 0</End></Line>
{second}
</CoordGeom>
<Profile><ProfAlign name="p"><PVI>100 50</PVI>{pvi}</ProfAlign></Profile>
</Alignment></Alignments></LandXML>"""
ARC = '<Curve rot="cw"><Start>10 0</Start><Center>10 5</Center><End>15 5</End></Curve>'


def landxml(tmp_path, length=10 + 2.5 * np.pi, second=ARC, pvi="<PVI>110 49</PVI><PVI>120 49</PVI>"):
    path = tmp_path / "line.xml"
    path.write_text(LANDXML.format(length=length, second=second, pvi=pvi))
    return path


def test_an_alignment_has_lines_arcs_and_heights(tmp_path):
    line = read_design_line(landxml(tmp_path), of="invert")
    east, north, up = (line[name].values for name in ("easting", "northing", "elevation"))
    assert (east[0], north[0], up[0]) == (0.0, 0.0, 50.0)
    assert (east[-1], north[-1], up[-1]) == pytest.approx((5.0, 15.0, 49.0))
    on_arc = north > 10.0 + 1e-9
    np.testing.assert_allclose(np.hypot(east[on_arc] - 5.0, north[on_arc] - 10.0), 5.0, atol=1e-9)
    middle = np.flatnonzero(np.isclose(north, 10.0))[0]
    assert up[middle] == pytest.approx(49.0)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"second": "<Spiral/>"}, "its plan holds a Spiral"),
        ({"second": "<Line><Start>11 0</Start><End>12 0</End></Line>"}, "a gap before its 2. piece"),
        ({"second": ARC.replace(' rot="cw"', "")}, "does not say its sense"),
        ({"second": ARC.replace("10 5<", "ten 5<")}, "'ten 5'"),
        ({"pvi": ""}, "does not run on"),
        ({"pvi": "<PVI>90 1</PVI>"}, "does not run on"),
        ({"pvi": '<ParaCurve length="3">110 49</ParaCurve>'}, "its profile holds a ParaCurve"),
        ({"length": "x"}, "Alignment, length"),
    ],
)
def test_alignments_that_cannot_be_used_are_refused(tmp_path, change, said):
    with pytest.raises(InputError) as caught:
        read_design_line(landxml(tmp_path, **change), of="axis")
    assert said in str(caught.value)
    with pytest.raises(InputError, match="axis or of the invert"):
        read_design_line(landxml(tmp_path))
