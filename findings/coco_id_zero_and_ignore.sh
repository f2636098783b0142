#!/bin/bash
# COCO's official evaluation (pycocotools 2.0.11): a detection that lies exactly on the only object counts as a miss
# (AP 0) if that annotation's id is 0, because a match is stored as the annotation's id and 0 means none. With id 1
# the AP is 1. And "ignore": 1 in an annotation, which the code seems to honour, has no effect: it is set anew from
# "iscrowd" before it is looked at, so that the object still counts.
set -eu
T=$(mktemp -d); trap 'rm -rf "$T"' EXIT; cd "$T"
python3 -m venv v; v/bin/pip install -q pycocotools==2.0.11 numpy==2.2.6
cat > a.py <<'P'
import contextlib, io, json
from pycocotools.coco import COCO
from pycocotools.cocoeval import COCOeval
def ap(**annotation):
    box = [10, 10, 50, 50]
    gt = {"images": [{"id": 1, "width": 200, "height": 200}], "categories": [{"id": 1, "name": "a"}],
          "annotations": [dict({"id": 1, "image_id": 1, "category_id": 1, "bbox": box, "area": 2500, "iscrowd": 0}, **annotation)]}
    json.dump(gt, open("gt.json", "w"))
    with contextlib.redirect_stdout(io.StringIO()):
        g = COCO("gt.json"); d = g.loadRes([{"image_id": 1, "category_id": 1, "bbox": box, "score": 0.9}])
        e = COCOeval(g, d, "bbox"); e.evaluate(); e.accumulate(); e.summarize()
    return round(float(e.stats[0]), 3)
seen = {"id 1": ap(), "id 0": ap(id=0), "ignore 1": ap(ignore=1), "iscrowd 1": ap(iscrowd=1)}
print("pycocotools 2.0.11, AP of one perfect hit:", seen)
assert seen == {"id 1": 1.0, "id 0": 0.0, "ignore 1": 1.0, "iscrowd 1": -1.0}
P
v/bin/python a.py
