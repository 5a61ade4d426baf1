"""The list of known sites."""

import json


def test_the_table_names_every_site_with_its_coordinates(acutance):
    result = acutance("sites")
    assert result.exit_code == 0
    line = next(line for line in result.stdout.splitlines() if line.startswith("stennis"))
    assert "30.38667" in line
    assert "-89.62861" in line


def test_json_holds_all_that_is_known(acutance):
    document = json.loads(acutance("sites", "--json").stdout)
    assert document["schema"] == "acutance/sites/1"
    names = {site["name"] for site in document["sites"]}
    assert {"salon-de-provence", "baotou"} <= names
    assert all(site["source"] for site in document["sites"])
