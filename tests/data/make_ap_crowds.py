"""Writes ap_crowds.json: AP of pycocotools on seeded random images with crowds. Needs `pip install pycocotools`."""
import json, random, io, contextlib
from pycocotools.coco import COCO
from pycocotools.cocoeval import COCOeval
random.seed(16)
def box():
    x,y=random.uniform(0,80),random.uniform(0,80); return [round(v,2) for v in (x,y,random.uniform(8,50),random.uniform(8,50))]
def near(b,s): return [round(v+random.uniform(-s,s),2) if i<2 else round(max(2,v+random.uniform(-s,s)),2) for i,v in enumerate(b)]
cases=[]
while len(cases)<24:
    images=[];anns=[];dets=[]
    for i in range(1,7):
        images.append({"id":i,"width":200,"height":200})
        own=[]
        for _ in range(random.randint(0,4)):
            b=box(); crowd=int(random.random()<.35)
            if crowd: b[2]*=2; b[3]*=2
            own.append((b,crowd)); anns.append({"id":len(anns)+1,"image_id":i,"category_id":1,"bbox":b,"area":b[2]*b[3],"iscrowd":crowd})
        for b,crowd in own:
            for _ in range(random.randint(0,3)):
                d=near(b,6) if not crowd else [b[0]+random.uniform(-6,b[2]),b[1]+random.uniform(-6,b[3]),random.uniform(4,25),random.uniform(4,25)]
                dets.append({"image_id":i,"category_id":1,"bbox":[round(v,2) for v in d],"score":round(random.random(),6)})
        for _ in range(random.randint(0,2)): dets.append({"image_id":i,"category_id":1,"bbox":box(),"score":round(random.random(),6)})
    if not any(not a["iscrowd"] for a in anns) or not dets: continue
    with contextlib.redirect_stdout(io.StringIO()):
        gt=COCO(); gt.dataset={"images":images,"annotations":anns,"categories":[{"id":1,"name":"car"}]}; gt.createIndex()
        e=COCOeval(gt,gt.loadRes(dets),"bbox"); e.evaluate(); e.accumulate(); e.summarize()
    cases.append({"images":[{"truths":[a["bbox"] for a in anns if a["image_id"]==i["id"] and not a["iscrowd"]],"crowds":[a["bbox"] for a in anns if a["image_id"]==i["id"] and a["iscrowd"]],
      "detections":[[d["score"],*d["bbox"]] for d in dets if d["image_id"]==i["id"]]} for i in images],"ap_50":e.stats[1],"ap_50_95":e.stats[0]})
print(json.dumps(cases,separators=(",",":")))
