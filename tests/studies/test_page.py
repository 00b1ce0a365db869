"""The report: what it must hold and never hold, read as markup and in a browser where there is one."""

import base64
import hashlib
import html
import io
import json
import re
import shutil
import subprocess
from xml.etree import ElementTree

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure
from PIL import Image

from studies import manifest
from studies.html_table import MOST_CELLS, all_of, sortable
from studies.inline_svg import inline_svg
from studies.page import page
from studies.plain_answer import plain_answer
from studies.study import made

SVG = "{http://www.w3.org/2000/svg}"
HREF = "{http://www.w3.org/1999/xlink}href"
HOSTILE = "</title></script><script>boo()</script><img src='http://example.org/x.png' onerror=boo()> & \"$name\" \x01"
TREE = {
    "name": "hostile",
    "question": HOSTILE,
    "sonar": {"preset": "hisas-100khz"},
    "patch": {"looks": 9, "snr": 10},
    "axes": [{"patch.snr": [0, 10]}],
    "estimators": [{"name": "cross-correlation", "method": "CrossCorrelation"}],
    "trials": {"count": 1, "block": 1},
    "figures": [
        {"name": "rate", "x": "snr", "y": "wrap_rate", "across": "looks", "scale": "log", "x_label": "<b>SNR</b> & x"},
        {"name": "rmse", "x": "snr", "y": "rmse", "level": 1.0, "legend": "a > b; </svg><script>boo()</script>"},
    ],
    "summary": {"columns": ["snr", "estimator", "wrap_rate", "note"]},
}


def table_of(rows=60):
    rng = np.random.default_rng(1)
    rate = 10.0 ** rng.uniform(-9, 0, rows)
    rate[3] = np.nan
    return pd.DataFrame(
        {
            "snr": np.append(rng.permutation(rows - 1) - 9.0, np.inf),
            "estimator": ["cross-correlation", "split-spectrum"] * (rows // 2),
            "looks": [9, 33] * (rows // 2),
            "wrap_rate": rate,
            "wrap_rate_low": rate / 2,
            "wrap_rate_high": rate * 2,
            "rmse": rng.uniform(1, 2, rows),
            "rmse_se": 0.1,
            "few_dominate": rate > 0.1,
            "note": HOSTILE,
            **{f"a_long_name_of_a_column_{n}": rng.standard_normal(rows) for n in range(12)},
        }
    )


def written(folder):
    study, table = made(TREE, "test"), table_of()
    manifest.begin(study, 2026, folder)
    figures = {section.name: section.drawn(table, []) for section in study.figures}
    return page(study, table, f"It is {HOSTILE}.", [f"beware of {HOSTILE}"], figures, folder)


@pytest.fixture(scope="module")
def text(tmp_path_factory):
    return written(tmp_path_factory.mktemp("page"))


@pytest.fixture(scope="module")
def root(text):
    return ElementTree.fromstring(text)


def test_a_page_is_well_formed_and_asks_for_nothing(root):
    assert root.tag == "html"
    for element in root.iter():
        for key, value in element.attrib.items():
            assert not re.search(r"https?:|//|@import|javascript:", value), (element.tag, key)
            assert not key.startswith("on")
            if key in ("src", "href", HREF):
                assert value.startswith(("#", "data:")), (element.tag, value[:40])
    for style in root.iter("style"):
        assert not re.search(r"url\(|@import", style.text)


def test_text_of_anyone_is_text(root):
    (script,) = root.iter("script")
    assert "boo" not in script.text
    shown = "".join(root.itertext())
    # The question, the title of the figures' axes and legends, a cell of each table, the warning, the answer.
    seen = HOSTILE.replace("\x01", "\ufffd")
    assert root.find(".//p[@class='question']").text == seen
    assert root.find(".//p[@class='answer']").text == f"It is {seen}."
    assert root.find(".//p[@class='warning']").text == f"beware of {seen}"
    assert sum(cell.text == seen for cell in root.iter("td")) == 60
    assert f"note {seen}" in shown
    words = ["".join(element.itertext()) for element in root.iter(f"{SVG}text")]
    assert "<b>SNR</b> & x" in words
    assert "</svg><script>boo()</script>" in words


def test_the_policy_allows_its_own_script_alone(root):
    (policy,) = (m.attrib["content"] for m in root.iter("meta") if "http-equiv" in m.attrib)
    (script,) = root.iter("script")
    digest = base64.b64encode(hashlib.sha256(script.text.encode()).digest()).decode()
    assert policy == f"default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'sha256-{digest}'"


def test_ids_are_unique_and_references_stay_in_their_figure(root):
    ids = [element.attrib["id"] for element in root.iter() if "id" in element.attrib]
    assert len(ids) == len(set(ids)) >= 10
    for svg in root.iter(f"{SVG}svg"):
        own = {element.attrib["id"] for element in svg.iter() if "id" in element.attrib}
        values = [value for element in svg.iter() for value in element.attrib.values()]
        used = {name for value in values for name in re.findall(r"^#(.+)|url\(#(.+?)\)", value)}
        assert {a or b for a, b in used} == own
    assert len(list(root.iter(f"{SVG}svg"))) == 2


def test_a_page_is_the_same_for_the_same_study(text, tmp_path):
    assert written(tmp_path) == text


def test_points_have_their_intervals_and_the_bound_its_line(root):
    rate, rmse = root.iter(f"{SVG}svg")
    # No interval is named in the study file, but the table has some: a bar for each point that is a number.
    for svg, known in ((rate, 58), (rmse, 59)):
        paths = [(p.attrib.get("d", "").split(), p.attrib.get("style", "")) for p in svg.iter(f"{SVG}path")]
        bars = [d for d, style in paths if len(d) == 6 and re.search("stroke: #(0072b2|d55e00)$", style)]
        assert sum(d[1] == d[4] and d[2] != d[5] for d in bars) == known
    bound = "fill: none; stroke: #000000; stroke-width: 0.8; stroke-linecap: square"
    (across,) = (d for d, style in paths if style == bound)
    assert across[1] != across[4]
    assert across[2] == across[5]
    assert rmse.attrib["aria-label"] == "rmse: RMSE [s] against SNR [dB]"


def test_many_points_and_maps_become_pixels(tmp_path):
    rng = np.random.default_rng(1)
    figure = Figure()
    panel, below = figure.subplots(2)
    panel.plot(rng.standard_normal(50_000), ".", label="cloud")
    panel.plot([0, 50_000], [0, 1], label="line")
    values = rng.uniform(size=(200, 300))
    below.pcolormesh(values, rasterized=True)
    svg = ElementTree.fromstring(inline_svg(figure, "f-", "cloud & map"))
    images = [image.attrib[HREF] for image in svg.iter(f"{SVG}image")]
    assert len(images) == 2
    # As vectors it would be 3 MB.
    assert len(ElementTree.tostring(svg)) < 300_000
    raw = [base64.b64decode(image.split(",", 1)[1]) for image in images]
    cloud, shown = (Image.open(io.BytesIO(data)) for data in raw)
    assert (shown.mode, shown.convert("RGBA").getpixel((150, 40))[3]) == ("P", 255)
    figure.savefig(tmp_path / "plain.svg", dpi=120)
    plain = [e.attrib[HREF] for e in ElementTree.parse(tmp_path / "plain.svg").iter(f"{SVG}image")]
    for found, expected in zip((cloud, shown), plain, strict=True):
        original = Image.open(io.BytesIO(base64.b64decode(expected.split(",", 1)[1])))
        np.testing.assert_array_equal(np.asarray(found.convert("RGBA")), np.asarray(original.convert("RGBA")))


def test_tables_hold_what_is_told():
    table = pd.DataFrame({"x": [0.123456, np.nan, np.inf], "same": [7, 7, 7], "ok": [True, False, True]})
    found = ElementTree.fromstring(f"<div>{all_of(table)}</div>")
    assert found.find("p").text == "The same in all rows: same 7."
    cells = [[cell.text for cell in row.iter("td")] for row in found.iter("tr")][1:]
    assert cells == [["0.1235", "True"], [None, "False"], ["inf", "True"]]
    assert [head.attrib.get("class") for head in found.iter("th")] == [None, "text"]
    long = pd.DataFrame({"a": np.arange(MOST_CELLS), "b": np.arange(MOST_CELLS) % 7})
    cut = ElementTree.fromstring(f"<div>{all_of(long)}</div>")
    assert "".join(cut.find("p").itertext()) == f"The first {MOST_CELLS // 2} of {MOST_CELLS} rows; table.csv has all."
    assert len(list(cut.iter("tr"))) == MOST_CELLS // 2 + 1
    assert sortable(pd.DataFrame({"a": []})).count("<tr>") == 1


def test_a_study_without_words_has_ranges():
    table = pd.DataFrame({"estimator": ["a", "a", "b"], "wrap_rate": [0.25, 0.5, 0.125], "rmse": [np.nan, np.nan, 2.0]})
    said = ["a, 2 rows: the wrap-error rate is 0.25 to 0.5", "b, 1 row: the wrap-error rate is 0.125, the RMSE is 2 s"]
    assert plain_answer(table) == f"{'. '.join(said)}."
    assert plain_answer(pd.DataFrame({"sediment": ["silt"]})) == ""


@pytest.mark.parametrize(
    ("commits", "said"),
    [
        (["abc"], []),
        (["abc-dirty"], ["some of the numbers come from code with changes that were not committed"]),
        ([None], ["it is not known from which commit all of the numbers come"]),
        (["abc", "abd"], ["the numbers come from 2 states of the code"]),
    ],
)
def test_a_page_says_where_it_comes_from(tmp_path, commits, said):
    study = made({**TREE, "question": "What?", "figures": []}, "test")
    manifest.begin(study, 7, tmp_path)
    found = json.loads((tmp_path / manifest.NAME).read_text())
    found["fixed"]["estimators.own"] = {"method": "whitened", "options": {}, "source": "delays 1.5 0123456789abcdef"}
    found["runs"] = [{"commit": commit, "numpy": "2.0.1", "machine": "x86_64"} for commit in commits]
    (tmp_path / manifest.NAME).write_text(json.dumps(found))
    root = ElementTree.fromstring(page(study, table_of(), "Yes.", [], {}, tmp_path))
    assert [p.text for p in root.findall(".//p[@class='warning']")] == said
    pres = [element.text for element in root.iter("pre")]
    checkout = [f"git checkout {commits[-1].removesuffix('-dirty')}"] if commits[-1] else []
    assert pres[0].splitlines() == [*checkout, "python -m pip install --editable . numpy==2.0.1"]
    assert pres[1:3] == ["twinecho run manifest.json --seed 7 --out again", "twinecho report ."]
    rows = [["".join(cell.itertext()) for cell in row] for row in root.iter("tr")]
    assert ["seed", "7"] in rows
    assert [row for row in rows if row[0].startswith("estimator ")] == [
        ["estimator whitened", "delays 1.5 0123456789abcdef"]
    ]
    assert ["commit", *(commit or "not known" for commit in commits)] in rows


BROWSER = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
in_a_browser = pytest.mark.skipif(BROWSER is None, reason="no chromium is installed, and no Python package brings one")

PROBE = """
const report = {};
const table = document.querySelectorAll("table.sortable")[1], heads = [...table.tHead.rows[0].cells];
const column = name => heads.findIndex(head => head.textContent === name);
const shown = name => [...table.tBodies[0].rows].map(row => row.cells[column(name)].textContent);
const press = name => heads[column(name)].querySelector("button").click();
document.querySelector("details.numbers").open = true;
report.before = shown("wrap_rate");
press("wrap_rate"); report.up = shown("wrap_rate"); report.beside = shown("snr");
report.aria = heads.map(head => head.getAttribute("aria-sort"));
press("wrap_rate"); report.down = shown("wrap_rate");
press("snr"); report.snr = shown("snr");
press("estimator"); report.words = shown("estimator");
report.afterwards = heads.map(head => head.getAttribute("aria-sort"));
report.keys = [...document.querySelectorAll("th button")].every(button => button.tabIndex === 0);
report.width = [window.innerWidth, document.documentElement.scrollWidth, document.body.scrollWidth];
const asked = performance.getEntriesByType("resource").map(entry => entry.name);
report.outside = asked.filter(name => !name.startsWith("data:"));
const words = [...document.querySelectorAll("svg text")];
report.letters = Math.min(...words.map(word => word.getBoundingClientRect().height));
report.scripts = document.scripts.length;
const probe = document.createElement("pre");
probe.id = "probe"; probe.textContent = JSON.stringify(report); parent.document.body.append(probe);
"""


def browse(path):
    """What the browser makes of a page, and the lines of its console."""
    options = ["--headless", "--no-sandbox", "--disable-gpu", "--enable-logging=stderr", "--virtual-time-budget=3000"]
    call = [BROWSER, *options, f"--user-data-dir={path.parent / 'profile'}", "--window-size=1400,1000", "--dump-dom"]
    done = subprocess.run([*call, path.as_uri()], capture_output=True, text=True, check=True, timeout=120)
    return done.stdout, [line for line in done.stderr.splitlines() if "CONSOLE" in line]


@in_a_browser
def test_a_browser_has_nothing_to_complain_of(text, tmp_path):
    (tmp_path / "report.html").write_text(text, encoding="utf-8")
    dom, console = browse(tmp_path / "report.html")
    assert console == []
    # The script ran: heads of both tables became buttons.
    assert dom.count('<button type="button">') == 4 + 20
    # And were there something from outside, it would be seen.
    (tmp_path / "bad.html").write_text(text.replace("</main>", '<img src="http://127.0.0.1:9/x.png"/></main>'))
    assert any("Content Security Policy" in line for line in browse(tmp_path / "bad.html")[1])


@in_a_browser
@pytest.mark.parametrize("width", [390, 1280])
def test_a_page_sorts_and_fits(text, tmp_path, width):
    without_policy = re.sub(r"<meta http-equiv=.*?/>", "", text)
    probed = html.escape(without_policy.replace("</body>", f"<script>{PROBE}</script></body>"))
    # In a frame, as windows have a least width.
    frame = f'<!DOCTYPE html><iframe srcdoc="{probed}" style="width: {width}px; height: 900px; border: 0"></iframe>'
    (tmp_path / "report.html").write_text(frame, encoding="utf-8")
    dom, console = browse(tmp_path / "report.html")
    assert console == []
    found = json.loads(html.unescape(re.search(r'<pre id="probe">(.*?)</pre>', dom, re.DOTALL)[1]))
    table = table_of()
    rates = [f"{rate:.4g}" for rate in sorted(table.wrap_rate.dropna())]
    assert found["before"] == ["" if np.isnan(rate) else f"{rate:.4g}" for rate in table.wrap_rate]
    assert found["up"] == [*rates, ""]
    assert found["down"] == [*rates[::-1], ""]
    # Rows stay whole.
    assert found["beside"][0] == f"{table.snr[table.wrap_rate.idxmin()]:.4g}"
    assert found["snr"] == [f"{snr:.4g}" for snr in sorted(table.snr)]
    assert found["words"] == sorted(table.estimator)
    assert found["aria"].count("ascending") == 1
    assert found["aria"][list(table.columns).index("wrap_rate")] == "ascending"
    assert found["afterwards"].count(None) == len(found["afterwards"]) - 1
    assert found["keys"]
    assert found["width"][0] == width
    assert max(found["width"]) == width
    assert found["outside"] == []
    # Words in figures can still be read.
    assert found["letters"] >= 8
    # That of the page, and the probe: none that a study brought.
    assert found["scripts"] == 2
