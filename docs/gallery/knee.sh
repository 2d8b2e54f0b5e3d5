# A knee with four contacts
# Two condyles, two plateaus and a kneecap, held by ligaments: pressure on both plateaus of the tibia.
# files: samples/knee/knee.feb
dea run knee.feb --states last
dea plot knee_dea.xplt --surface medial_plateau --surface lateral_plateau --columns 2 -o knee.svg
