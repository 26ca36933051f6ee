"""Reads unit_loads.bdf with pyNastran and prints one JSON object. Exit code 77 if the package is missing.

    python read_cases.py FILE
"""
import json
import sys

try:
    from pyNastran.bdf.bdf import read_bdf
except Exception as e:  # missing, or incompatible versions
    print(f"absent: {e}")
    sys.exit(77)

model = read_bdf(sys.argv[1], xref=False, debug=None)
subcases = {}
for number, subcase in model.case_control_deck.subcases.items():
    if number == 0:
        continue
    stated = {name: subcase.params[name] for name in subcase.params}
    load = stated["LOAD"][0]
    subcases[str(number)] = {
        "label": stated["LABEL"][0],
        "spc": "SPC" in stated,
        "strain": [str(option) for option in stated["STRAIN"][1]],
        "loads": [[card.type, card.node, [float(card.mag * x) for x in card.xyz]] for card in model.loads[load]],
    }
params = {name: model.params[name].values[0] for name in ("POST", "INREL")}
print(json.dumps({"sol": model.sol, "params": params, "grids": len(model.nodes), "subcases": subcases}))
