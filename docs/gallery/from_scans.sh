# From surfaces of bones to pressures
# Bones and cartilage as STL files become a model with ligaments, flexed by a table; the state is that of 30 degrees.
# files: samples/made_knee/make_knee.py
python3 make_knee.py
dea build --bone femur=knee_femur.stl --cartilage femur=knee_femoral_cartilage.stl \
  --bone tibia=knee_tibia.stl --cartilage tibia=knee_tibial_cartilage.stl --center femur=0,0,0 \
  --motion femur=knee_flexion.csv --motion-rotation zxy --motion-units deg-mm \
  --ligaments knee_ligaments.csv --force tibia=0,0,700 -o made_knee.feb
dea run made_knee.feb --skip-steps
dea plot made_knee_dea.xplt --up 0,1,0 --columns 2 --surface tibia_cartilage_1_articular \
  --surface tibia_cartilage_2_articular -o from_scans.svg
