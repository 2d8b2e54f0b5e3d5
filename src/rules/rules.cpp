#include "src/rules/rules.h"

#include <algorithm>
#include <map>

#include "src/base/numbers.h"
#include "src/rules/look.h"

namespace dea {

namespace {

constexpr Severity I = Severity::Ignored, N = Severity::Note, W = Severity::Warning;

/// What readers of files have remarked, by its place.
Findings remark_findings(const JointModel& model, const char* code, const std::vector<Remark>& remarks) {
  Findings found;
  for (const Remark& r : remarks)
    found.push_back({code, {}, {{"what", r.what}, {"count", r.count}}, r.count > 1 ? 1 : 0, place_of(model, r.origin)});
  return found;
}

Findings ignored_input(const JointModel& model, const Joint& joint) {
  Findings found = remark_findings(model, "input-ignored", model.ignored);
  for (const ContactPair& pair : joint.contacts) {
    const Contact& contact = model.contacts[at(pair.contact)];
    for (const std::string& what : contact.ignored)
      found.push_back(
          {"input-ignored", {.contact = contact.name}, {{"what", what}}, 2, place_of(model, contact.origin)});
  }
  return found;
}

Findings assumed_input(const JointModel& model, const Joint&) {
  return remark_findings(model, "input-assumed", model.assumed);
}

using OfModel = Findings (*)(const JointModel&, const Joint&);
using OfResult = Findings (*)(const JointModel&, const Joint&, const SolvedStates&);
using Texts = std::vector<Words>;

Rule told(const char* code, const char* acts, const Texts& words) { return {code, acts, words}; }
Rule quiet(const char* code, const char* acts, const Texts& words) { return {code, acts, words, true}; }
Rule of_model(const char* code, const char* acts, const Texts& words, OfModel look) {
  return {code, acts, words, false, look};
}
Rule of_result(const char* code, const char* acts, const Texts& words, OfResult look) {
  return {code, acts, words, false, nullptr, look};
}
Rule quiet_of_result(const char* code, const char* acts, const Texts& words, OfResult look) {
  return {code, acts, words, true, nullptr, look};
}

/// What recognition tells as it goes (told), what a rule finds in a model or in what was solved.
std::vector<Rule> all_rules() {
  return {
      // ---- there is no answer, or one to another question
      of_result("no-solution", "Do not use these states. The sentence says what stopped the search.",
                {{W, "time {time}: {what}: {detail}"},
                 {W, "times {from} to {time} ({states} states): {what}; at time {time}: {detail}"}},
                no_solution),
      of_result(
          "nothing-loads", "Give a load, or hold or prescribe the motion.",
          {{W,
            "at time {time} nothing loads {bodies?body|bodies} {bodies}, though {bodies?it is|they are} free to move, "
            "and {surfaces}: there is no contact to look at; give a load with {give}, or hold or prescribe the motion"},
           {W,
            "at time {time} nothing loads a free body, and {surfaces}: there is no contact to look at; give a load "
            "with {give}, or hold or prescribe the motion"}},
          nothing_loads),
      of_result("never-touching", "Check the prescribed motions and where the bodies start.",
                {{W, "the surfaces touch in no state: the motions that are prescribed bring them nowhere together"}},
                never_touching),
      of_result("passed-through", "Check the prescribed motion and its units.",
                {{W,
                  "contact \"{contact}\": at time {time} the surfaces have passed through each other, by more than "
                  "four times their thickness: that is no contact any more, and none is shown; check the motion that "
                  "is prescribed, and its units"}},
                passed_surfaces),
      of_result("contact-unloaded", "Look at the load's direction and at the joints.",
                {{W,
                  "at time {time} no contact carries any load, though the bodies balance: joints, ligaments or what "
                  "holds the bodies take all of it; look at the load's direction and at the joints"}},
                unloaded_contact),
      told("matrix-units", "Say the unit of the matrices' translations.",
           {{W,
             "{file}: its matrices of body \"{body}\" have {doubt}: if they are in m, say {give}; if they are in mm, "
             "{stays}"}}),
      of_model("odd-units",
               "Check the units, the modulus and the lengths: pressures may be wrong by a factor of a thousand or a "
               "million.",
               {{W,
                 "surface \"{surface}\": E = {E:g} is {megapascals:.3g} MPa in the model's units, {system}; cartilage "
                 "has 0.1 to 100 MPa: check the modulus and the units"},
                {W,
                 "surface \"{surface}\": its size, {size:.3g}, is {metres:.3g} m in the model's units, {system}: check "
                 "the units"},
                {W,
                 "surface \"{surface}\": E = {E:g} on a surface of size {size:.3g} looks as if {as_if}: forces would "
                 "come out wrong by a million; convert the model to one system of units ({units} only names it and "
                 "changes no number)"}},
               odd_units),
      of_model("sizes-differ", "Convert one of the bodies to the other's unit of length.",
               {{W,
                 "contact \"{contact}\": surface \"{surface}\" is {size:.3g} large and surface \"{other}\" "
                 "{other_size:.3g}: is one of the bodies in another unit of length, as metres?"}},
               sizes_that_differ),
      of_result("tiny-load", "Check the unit of the load.",
                {{W,
                  "forces of at most {force:.3g} are next to nothing for this cartilage ({ratio:.2g} of its modulus "
                  "times its area): is the load in another unit, as kN?"}},
                tiny_load),
      of_result("idle-load", "Load another body, or let this one move.", {{W, "{given}: {why}"}}, without_effect),
      told("idle-model-load", "Let the body move along that axis, or leave the load out.",
           {{W, "force{load} along {axis} has no effect: body \"{body}\" is {by} along that axis"},
            {W, "moment{load} about {axis} has no effect: body \"{body}\" is {by} about that axis"}}),
      told("idle-load-point", "Give a force, or leave the point out.",
           {{W,
             "{given}: it has no effect, for no rigid force acts on body \"{body}\" (other forces have points of their "
             "own); give one with {give}, or leave it out"},
            {W, "{given}: it has no effect, for body \"{body}\" is not free to turn"}}),
      told("idle-setting", "Name another surface or body, or leave the setting out.",
           {{W, "{given}: it has no effect, for no sliding contact has this surface"},
            {W,
             "{given}: it has no effect, for no setting turns body \"{body}\"; turn it with {turn}, or leave it out"}}),
      // ---- the joint is another one than the model's
      told("part-not-modelled", "Put springs in its place if it carries load.",
           {{W,
             "{parts?part|parts} {parts} ({elements} deformable {elements?element|elements}) {parts?fastens|fasten} "
             "body {bodies} to nodes that are held in {components:plain}, and {parts?is|are} not modelled: the force "
             "{parts?it carries|they carry} as the body moves is missing in the balance; put springs between the body "
             "and the ground in {parts?its|their} place if it matters"},
            {W,
             "{parts?part|parts} {parts} ({elements} deformable {elements?element|elements}) {parts?joins|join} bodies "
             "{bodies} and {parts?is|are} not modelled: the force {parts?it carries|they carry} as these bodies move "
             "is missing in the balance; put springs between the bodies in {parts?its|their} place if it matters"}}),
      told("tie-left-out", "Give both bodies one rigid material, or a rigid joint that locks them.",
           {{W,
             "{tie} fastens rigid bodies \"{body}\" and \"{other}\" to each other, which is not modelled: they move as "
             "if it were not there; give both one rigid material, or a rigid joint that locks them"}}),
      told("pieces-side-by-side", "Mesh the pieces so that they share nodes.",
           {{W,
             "{tie} fastens pieces of cartilage on body \"{body}\" side by side, which is not modelled: each has a "
             "free edge there; mesh them so that they share nodes"}}),
      told("tie-closes-gap", "Close the gaps in the mesh, or use tied-elastic.",
           {{W,
             "contact \"{contact}\" of type {type}: FEBio pulls the {nodes} tied nodes, and their layer with them, "
             "onto the surface they are tied to, over gaps or overlaps of {mean:.3g} on average ({most:.3g} at most); "
             "dea leaves the layer where it is meshed, so that its joint space is another one; close the gaps in the "
             "mesh, or use tied-elastic, which keeps them in FEBio too"}}),
      told("plane-half-held", "Hold the rest of the plane's nodes if it is a plane of symmetry.",
           {{W,
             "surface \"{surface}\": {unheld} of {edges} edges of its rim in the plane {axis} = {at:.6g} have nodes "
             "that are not held in {axis}, as others of the layer in that plane are: they are free edges; hold these "
             "nodes too if it is a plane of symmetry"}}),
      told("plane-held-across", "Hold the nodes across the plane if it is a plane of symmetry.",
           {{W,
             "surface \"{surface}\", plane {axis} = {at:.6g}: where its layer ends, nodes are held in {instead}, not "
             "in {axis}: taken for a free edge, without that hold; hold them in {axis} if it is a plane of symmetry"}}),
      told("plane-node-forgotten", "Hold these nodes too.",
           {{W,
             "surface \"{surface}\", plane {axis} = {at:.6g}: {forgotten} of {of} nodes of its layer are not held in "
             "{axis} ({nodes}): taken as held, as the others are; hold them too"}}),
      told("held-in-no-plane", "Let these nodes go, or expect a softer layer than in FEBio.",
           {{W,
             "surface \"{surface}\": {nodes:count} {nodes?node|nodes} of its layer ({nodes}) {nodes?is|are} held in "
             "{component}, in no plane of symmetry across {component}: that hold is left out, so the layer is softer "
             "there than in FEBio"}}),
      told("held-in-layer", "Hold the nodes of the bone face alone.",
           {{W,
             "surface \"{surface}\": {nodes:count} {nodes?node|nodes} of its pressed face ({nodes}) {nodes?is|are} "
             "held by its own body \"{holder}\", with cartilage under {nodes?it|them}: that hold is left out, and the "
             "face gives way there as elsewhere; hold the nodes of its bone face alone"},
            {W,
             "surface \"{surface}\": {nodes:count} {nodes?node|nodes} of its layer ({nodes}) {nodes?is|are} held by "
             "body \"{holder}\", not by its own, \"{body}\": that hold is left out"}}),
      // ---- the numbers are off: the most first
      of_result(
          "part-strained", "Load it less, or use FEBio: parts are linear.",
          {{W,
            "part \"{part}\" is strained by {strain:.3g}% and turned by {turn:.3g} degrees somewhere, and parts are "
            "linear: a disc that is pressed by 10% bears 10% too little, a beam that is turned by 6 or 20 degrees goes "
            "0.5 or 6% too far"}},
          strained_parts),
      of_result("large-strain", "Check load, modulus, thickness and units.",
                {{W,
                  "contact \"{contact}\": at time {time} cartilage is pressed together by {percent:.0f}% of its "
                  "thickness: check load, modulus, thickness and units if that is not meant"}},
                large_strains),
      of_result("narrow-contact", "Divide the facets, or mesh finer; do not quote peaks before.",
                {{W,
                  "contact \"{contact}\": at time {time} contact is {across:.1f} facets wide on surface \"{surface}\", "
                  "and these are long against the cartilage ({size:.2g} of its thickness): force may be "
                  "{force_percent}%, peak {peak_percent}% off; {finer}"},
                 {W,
                  "contact \"{contact}\": at time {time} contact is {across:.1f} facets wide on surface \"{surface}\", "
                  "and these are long against the cartilage ({size:.2g} of its thickness): force may be "
                  "{force_percent}%, peak {peak_percent}% off and more; {finer}"}},
                narrow_contact),
      of_result(
          "softening-material", "Use neo-Hookean in both programs.",
          {{W,
            "contact \"{contact}\": cartilage is pressed together by {percent:.0f}%, and its material \"{material}\" "
            "is \"isotropic elastic\", which in FEBio gets softer as it is compressed, where dea's laws get stiffer or "
            "stay as they are: p99 was 14% above FEBio's at 5%, 60% at 15%; neo-Hookean agrees"}},
          softening_material),
      of_model("thick-on-its-radius",
               "Expect pressures above FEBio's: 27 % in force where the thickness is a third of the radius.",
               {{W,
                 "surface \"{surface}\": its mean thickness, {thickness:.3g}, is {ratio:.2g} times the radius of its "
                 "sphere, {radius:.3g}: springs and the layer law suppose a thin layer, and pressures may come out "
                 "well above FEBio's"}},
               thick_layers),
      of_result(
          "force-at-edge",
          "Do not quote force and peak to better than this; let the contact end before the edge, or use FEBio.",
          {{N,
            "contact \"{contact}\": at time {time} {percent:.0f}% of its force presses surface \"{surface}\" within "
            "one thickness ({thickness:.3g}) of its layer's free edge: force may be {cost}%, pressures there 15% off"},
           {W,
            "contact \"{contact}\": at time {time} {percent:.0f}% of its force presses surface \"{surface}\" within "
            "one thickness ({thickness:.3g}) of its layer's free edge, at strains of up to {strain:.0f}%: where the "
            "other surface goes on over the edge, force and pressures there may be {cost}% too low"},
           {W,
            "contact \"{contact}\": at time {time} {percent:.0f}% of its force presses surface \"{surface}\" within "
            "one thickness ({thickness:.3g}) of its layer's free edge, which is undercut ({wall:.0f} degrees), at "
            "strains of up to {strain:.0f}%: where the other surface goes on over the edge, force and pressures there "
            "may be {cost}% too low"}},
          force_at_edge),
      of_result(
          "smeared-map", "Use the springs' own numbers, or mesh this surface finer.",
          {{W,
            "contact \"{contact}\": at time {time} the facets of surface \"{surface}\" are too long for this contact's "
            "map: their averages give area {area:.3g}, mean {mean:.3g}, p99 {p99:.3g}, the springs themselves "
            "{springs_area:.3g}, {springs_mean:.3g}, {springs_p99:.3g}; mesh this surface finer"}},
          smeared_map),
      of_result("crowded-force", "Look at the mesh, or divide the facets.",
                {{W,
                  "contact \"{contact}\": at time {time} {most} of {springs} springs carry nine tenths of the force, "
                  "too few for a pressure map: facets stand out of their surface, or they are long against the "
                  "contact; look at the mesh, or divide them with {refine}"}},
                crowded_force),
      of_result("few-springs", "Divide the facets, or let the finer surface carry the springs.",
                {{W,
                  "contact \"{contact}\": only {springs} springs carry at time {time}, too few for a pressure map; "
                  "divide them with {refine}, or let the other body's finer surface carry them with {source}"},
                 {W,
                  "contact \"{contact}\": at time {time} only {springs} springs carry, too few to follow how the "
                  "layers flow: force and peak may be 10% off; divide them with {refine}"}},
                few_springs),
      of_result("selection-ends-under-pressure", "Select the facets beyond as well.",
                {{W,
                  "surface \"{surface}\": at time {time} pressure reaches the end of the selected facets along "
                  "{length:.3g} of its rim, where the cartilage goes on: it is that of an edge there, too high if the "
                  "other surface covers what is beyond; select the facets beyond as well"}},
                pressed_selection),
      of_result("bare-surface-ends-under-pressure", "Select the facets beyond, or mesh more of the body.",
                {{W,
                  "at time {time} pressure reaches the end of bare surface \"{surface}\" along {length:.3g} "
                  "({percent:.0f}% of its rim), where its body's mesh goes on: there is no contact beyond, and its "
                  "edge presses like a punch's; select the facets beyond as well"},
                 {W,
                  "at time {time} pressure reaches the end of bare surface \"{surface}\" along {length:.3g} "
                  "({percent:.0f}% of its rim), where its mesh ends: there is no contact beyond, and its edge presses "
                  "like a punch's; mesh more of it if the body goes on there"},
                 {W,
                  "at time {time} pressure reaches the end of bare surface \"{surface}\" along {length:.3g} "
                  "({percent:.0f}% of its rim), where its mesh ends ({mesh:.3g}) or goes on unselected "
                  "({selection:.3g}): there is no contact beyond, and its edge presses like a punch's; select the "
                  "facets beyond, mesh more of it if the body goes on there"}},
                pressed_bare_rim),
      of_result("cut-under-pressure", "Hold the nodes of the cut if the joint goes on behind it as its mirror image.",
                {{W,
                  "contact \"{contact}\": at time {time} both surfaces end in the plane {plane} under pressure, up to "
                  "{pressure:.3g}, and the cartilage's nodes are not held across it: taken for free edges; if the "
                  "joint goes on behind it as its mirror image, hold these nodes in {axis}"}},
                cut_face),
      of_model(
          "no-thickness", "Check the bone surface and the units, or give a thickness.",
          {{W,
            "surface \"{surface}\": at {without} of {vertices} vertices its thickness is zero or next to it (less than "
            "{percent:g}% of the facets' size): this is hardly a layer of cartilage; check its bone surface and the "
            "units, or give {give}"},
           {N,
            "surface \"{surface}\": at {without} of {vertices} vertices its thickness is zero or next to it (less than "
            "{percent:g}% of the facets' size): no cartilage there, what is pressed there is as good as rigid"}},
          no_thickness),
      of_result("nearest-thickness-pressed", "Complete the bone under these vertices, or give a thickness.",
                {{W,
                  "surface \"{surface}\": at time {time} {count} of the vertices whose normals meet no bone carry "
                  "pressure, up to {pressure:.3g}: it is only as good as the distance to the nearest point of the bone "
                  "is a thickness; complete the bone under them, or give {give}"}},
                pressed_nearest_thickness),
      of_model("nearest-thickness", "Look whether the bone has a hole or ends too soon.",
               {{W,
                 "surface \"{surface}\": at {count} of {vertices} vertices the thickness is the distance to the "
                 "nearest point of the bone, for their normals meet no bone ({far} of them farther than two "
                 "thicknesses from its rim: does its bone have a hole, or end too soon?{shows_where})"}},
               nearest_thickness),
      of_result(
          "shear-at-edge", "Do not quote this peak; those farther from the edge hold.",
          {{W,
            "contact \"{contact}\": at time {time} the greatest shear inside the cartilage of {body} is within "
            "{near:g} {near?thickness|thicknesses} of its free edge, where it may be half too low at a steep side "
            "wall, a quarter too high at a bevel (docs/inside.md)"},
           {W,
            "contact \"{contact}\": at time {time} the greatest shear inside the cartilage of {body} is within "
            "{near:g} {near?thickness|thicknesses} of its free edge, whose side wall overhangs: there it may be a "
            "fifth off, and right beside the edge two thirds too low (docs/inside.md)"}},
          shear_at_edge),
      of_result("unstable-balance", "Look whether the joint is held as in the body: ligaments, other contacts.",
                {{W, "time {time}: {what}: {detail}"},
                 {W, "times {from} to {time} ({states} states): {what}; at time {time}: {detail}"}},
                unstable_balance),
      of_result(
          "large-turn", "Hold the rotations, or give what resists them.",
          {{W,
            "\"{body}\" has turned by {degrees:.0f} degrees about ({x:.2f}, {y:.2f}, {z:.2f}): its rotations are "
            "hardly resisted; to hold them type {hold}"},
           {W,
            "\"{body}\" has turned by {degrees:.0f} degrees about ({x:.2f}, {y:.2f}, {z:.2f}), as its joints let it"}},
          large_turn),
      of_result("far-travel", "Check where the bodies start.",
                {{W,
                  "\"{body}\" has moved by {way:.3g} before it was in balance, farther than its surface is large "
                  "({size:.3g}): are the bodies placed as they belong together? {move} brings them near"}},
                far_travel),
      // ---- how the model was taken, where a reader may want it otherwise
      of_model("drained-cartilage", "For an instant of walking give the constants before fluid has moved.",
               {{N,
                 "surface \"{surface}\": material \"{material}\" is {type}: its solid's constants (E {E:g}, nu {nu:g}) "
                 "are those of cartilage at rest, after its fluid has moved; an instant of walking is nearer to nu .5: "
                 "give {give_E} and {give_nu}"}},
               drained_cartilage),
      of_model("long-facets", "Divide the facets before numbers are quoted.",
               {{N,
                 "contact \"{contact}\": facets are long against the cartilage's thickness ({sizes}): right to about "
                 "3% where contact is 8 facets wide, force may be 40%, peak 70% off where it is 2 wide; once solved, a "
                 "warning tells if it is narrow; to be safe {finer}"},
                {W,
                 "contact \"{contact}\": facets are long against the cartilage's thickness ({sizes}): mesh it finer, "
                 "or is its thickness wrong?"}},
               long_facets),
      told("contacts-side-by-side", "Give both surfaces one E and nu, or make one contact with one surface of both.",
           {{N,
             "contacts \"{other}\" and \"{contact}\" press the same layer side by side (surfaces \"{other_surface}\", "
             "\"{surface}\"), and their materials differ: each is solved as if the other did not press; where both "
             "press within two thicknesses of each other their pressures come out too high or too low there"}}),
      told("not-thin", "Check thickness and bone surface.",
           {{N,
             "surface \"{surface}\": cartilage of mean thickness {thickness:.3g} is no thin layer on a strip between "
             "planes of symmetry whose half width is {half_width:.3g}; springs and the layer law suppose one: check "
             "{give_thickness} or {give_bone}"},
            {N,
             "surface \"{surface}\": cartilage of mean thickness {thickness:.3g} is no thin layer on a surface as "
             "large as a circle of radius {half_width:.3g}; springs and the layer law suppose one: check "
             "{give_thickness} or {give_bone}"}}),
      told("held-edges-in-no-plane", "Hold all nodes where the layer ends, or none.",
           {{N,
             "surface \"{surface}\": {edges} edges of its rim are held across an axis, but lie in no plane in which "
             "more than half of the layer's nodes are held (within {same_plane:.2g} of it): taken for a plane of "
             "symmetry, though FEBio lets the rest move freely; hold all nodes where the layer ends, or none, and put "
             "them into one plane"}}),
      told("face-stepped", "Smooth the mesh, or merge its nodes.",
           {{N,
             "surface \"{surface}\": steps or notches of up to {height:.3g} cross its face along {length:.3g} of "
             "edges; they are taken as free edges, though the layer goes on below them: pressures beside them come out "
             "too low; smooth the mesh, or merge its nodes"}}),
      quiet("rim-bevelled", "Do not quote pressures within a thickness of the bevel.",
            {{N,
              "surface \"{surface}\": the layer ends in a bevel along {length:.3g} of its rim (the next face turns by "
              "20 to 40 degrees), which is taken as going on: what presses within a thickness of it may come out 15% "
              "too high, 30% for a Poisson's ratio of 0.49"}}),
      told("tie-out-of-reach", "Give the contact a larger reach if the nodes are to be tied.",
           {{N,
             "contact \"{contact}\" of type {type} reaches {reach:g}, and {nodes} of {of} nodes lie {nearest:.4g} or "
             "more from the surface they would be tied to: they are not tied, in FEBio neither; if they are to be, "
             "write a larger <search_radius> (1 if it is not given) into it"},
            {N,
             "contact \"{contact}\" of type {type} reaches {reach:g}, and {nodes} of {of} nodes lie {nearest:.4g} or "
             "more from the surface they would be tied to: they are not tied, in FEBio neither; if they are to be, "
             "write a larger <max_distance> into it"}}),
      of_result("motion-held", "Nothing, if these motions do not matter; else load or resist them.",
                {{N,
                  "in {count} of {states} states motions were held that nothing resists or loads; at time {time}: "
                  "{directions}"}},
                held_motion),
      told(
          "held-in-some-steps", "Hold the nodes in all steps if that is meant.",
          {{N,
            "{nodes} {nodes?node of a deformable part is|nodes of deformable parts are} fixed in x, y and z at once in "
            "step {steps} only of the model; dea takes that for all steps"},
           {N,
            "{nodes} {nodes?node|nodes} of deformable parts {nodes?is|are} held in {component} in step {steps} only of "
            "the model; dea takes that for all steps"},
           {N, "contact \"{tie}\" ties its surfaces in step {steps} only of the model; dea takes that for all steps"},
           {N,
            "{nodes} {nodes?node of a deformable part is|nodes of deformable parts are} fixed in x, y and z at once in "
            "none of the steps of the model; dea takes that for all steps"},
           {N,
            "{nodes} {nodes?node|nodes} of deformable parts {nodes?is|are} held in {component} in none of the steps of "
            "the model; dea takes that for all steps"},
           {N, "contact \"{tie}\" ties its surfaces in none of the steps of the model; dea takes that for all steps"}}),
      told("plane-in-some-steps", "Hold the nodes in all steps if that is meant.",
           {{N,
             "surface \"{surface}\", plane {axis} = {at:.6g}: its nodes are held in step {held:plain} of {steps} "
             "steps, here in all of them"},
            {N,
             "surface \"{surface}\", plane {axis} = {at:.6g}: its nodes are held in none of {steps} steps, here in all "
             "of them"}}),
      told("first-material-for-all", "Give one modulus for the whole layer.",
           {{N,
             "surface \"{surface}\": its part consists of {materials}; the springs take the first for all of it "
             "(others with {give_E}, {give_nu})"}}),
      told("other-material-rigid", "Nothing, if the given thickness is of the first material.",
           {{N,
             "surface \"{surface}\": its thickness is given, so all of that is material \"{material}\"; \"{other}\" of "
             "the same part is left out, as if it were rigid"}}),
      told("cartilage-on-bare-surface", "Name a surface to give the thickness to that alone.",
           {{N,
             "surface \"{surface}\": a bare surface of body \"{body}\" is given {thickness:g} of cartilage ({given}, "
             "which is for all surfaces); name a surface to give it to that alone"}}),
      told("gap-to-bone", "Name the face of the layer's own elements if the gap is not meant.",
           {{N,
             "surface \"{surface}\": up to bone surface \"{bone}\" its cartilage is {taken:.3g} thick (the median), "
             "but its own elements are {elements:.3g}: the gap between them counts as cartilage; if that is not meant, "
             "name the face of its own elements with {give}"},
            {N,
             "surface \"{surface}\": up to bone surface \"{bone}\" its cartilage is {taken:.3g} thick (the median), "
             "but its own elements are {elements:.3g}: what lies beyond does not count; if that is not meant, name the "
             "face of its own elements with {give}"}}),
      told("facets-left-out", "Keep the facets if they are part of the articular face.",
           {{N,
             "surface \"{surface}\": {walls} of {facets} facets {walls?turns|turn} away from its articular face (side "
             "wall): left out ({keep} keeps them)"},
            {N,
             "surface \"{surface}\": {bonded} of {facets} facets {bonded?is|are} bonded to bone: left out ({keep} "
             "keeps them)"},
            {N,
             "surface \"{surface}\": {walls} of {facets} facets {walls?turns|turn} away from its articular face (side "
             "wall) and {bonded} {bonded?is|are} bonded to bone: left out ({keep} keeps them)"}}),
      told("shells-left-out", "Nothing, if the shells only cover the cartilage.",
           {{N,
             "surface \"{surface}\": deformable shells {shells} cover its cartilage; their stiffness and thickness are "
             "left out"}}),
      told("one-body", "Say which body each surface belongs to.",
           {{N, "contact \"{contact}\": both surfaces belong to body \"{body}\": left out"}}),
      told("joins-one-body", "Check the bodies that it names.",
           {{N, "{what} \"{name}\" joins two points of body \"{body}\": left out"}}),
      told("rigid-nodes-in-one-step", "Give the set for all steps if that is meant.",
           {{N, "rigid node set \"{set}\" is given for step {step} only; it is taken to hold its nodes in all steps"}}),
      told("taken-as-rigid", "Nothing: you asked for it.",
           {{N, "material \"{material}\" is taken as rigid ({given})"}}),
      told("left-out", "Nothing: you asked for it.",
           {{N,
             "{elements} elements of material \"{material}\" are left out, with {springs} {springs?spring|springs} and "
             "{forces} nodal {forces?force|forces} on them"},
            {W,
             "{elements} elements of material \"{material}\" are left out, with {springs} {springs?spring|springs} and "
             "{forces} nodal {forces?force|forces} on them, and {contacts?contact|contacts} {contacts}"}}),
      told("surface-divided", "Nothing. Give the part a surface of its own to name both yourself.",
           {{N,
             "surface \"{surface}\" lies on part \"{part}\" with {facets} of its {all} facets: these are taken as "
             "surface \"{name}\", with contacts of its own"}}),
      told("part-recognised",
           "Nothing, if it is a meniscus, a disc or a labrum. Take it as rigid, or give its surface a bone or a "
           "thickness, "
           "if it is not.",
           {{N, "part \"{part}\" gives way as its {elements} elements do ({give})"},
            {N,
             "\"{part}\" is a part of its own, for two contacts press it and nothing holds it: it gives way as its "
             "{elements} elements do; {rigid} takes it as rigid"},
            {N,
             "\"{part}\" is a part on body \"{body}\" and no layer, for behind most of what contacts press of it there "
             "is no bone: it gives way as its {elements} elements do; {rigid} takes it as rigid"},
            {N,
             "\"{part}\" is a part on body \"{body}\", for behind most of what contacts press of it there is no bone, "
             "as "
             "there is behind the layer it shares nodes with; those count as held: it gives way as its {elements} "
             "elements do; {rigid} takes it as rigid"},
            {N,
             "\"{part}\" is a part on body \"{body}\" with what hangs on it and has no bone behind it, and no layer: "
             "all of "
             "it gives way as its {elements} elements do; {rigid} takes it as rigid"}}),
      told("part-fibres",
           "Look at the modulus: of fibres that stiffen as they are drawn it depends on how far they are.",
           {{N,
             "the fibres of \"{material}\" ({type}) in part \"{part}\" add {modulus:.4g} along them, as at a strain of "
             "{strain:g}% (at 0, 3 and 6%: {at_0:.4g}, {at_3:.4g}, {at_6:.4g}; {give} takes that at 3%); they are "
             "linear and resist being shortened, too"},
            {W,
             "the fibres of \"{material}\" ({type}) in part \"{part}\" are left out, for their law or their direction "
             "is "
             "given in a way that is not read: what gives way is the matrix around them"},
            {N,
             "the fibres of \"{material}\" ({type}) in part \"{part}\" lie in many directions, and have the modulus "
             "{modulus:.4g} each, as at a strain of {strain:g}% (at 0, 3 and 6%: {at_0:.4g}, {at_3:.4g}, {at_6:.4g}; "
             "{give} takes that at 3%); they are linear and resist being shortened, too"}}),
      told("part-fluid", "For an instant of walking take what the fluid makes of it before it has moved.",
           {{N,
             "\"{material}\" of part \"{part}\" is {type} and taken as its solid (bulk modulus {drained:.4g}), as at "
             "rest, after its fluid has moved; for a load as fast as a step type {give} (bulk modulus {trapped:.4g})"},
            {N,
             "\"{material}\" of part \"{part}\" is {type} and taken as incompressible (bulk modulus {trapped:.4g}), "
             "for its fluid has had no time to move ({give}); at rest, without it, its solid bears alone (bulk modulus "
             "{drained:.4g})"}}),
      told("center-of-mass-left-out", "Give the centre of mass of the body's first material.",
           {{N,
             "material \"{material}\": its centre of mass {x:.4g},{y:.4g},{z:.4g} is left out, as in FEBio: it shares "
             "nodes with \"{body}\", is one body with it, and the centre of mass of that counts "
             "({body_x:.4g},{body_y:.4g},{body_z:.4g})"}}),
      told("center-of-mass-of-other", "Nothing, if the bodies belong together.",
           {{N, "material \"{material}\" is one body with \"{other}\", whose centre of mass counts"}}),
      told("density-varies", "Give the centre of mass if moments count about it.",
           {{N,
             "material \"{material}\" has a density that is not one number: the centre of mass of body \"{body}\" is "
             "taken as if its density were the same everywhere"}}),
      told("bodies-joined", "Give loads at the first body's centre of mass.",
           {{N,
             "rigid bodies \"{body}\" and \"{other}\" of the model are one body through what is taken as rigid between "
             "them: loads and motions of \"{other}\" count at the centre of mass of \"{body}\", where FEBio has two"}}),
      told("surface-meant", "Name the surface if another one is meant.",
           {{N,
             "{given} names no surface; it is taken for \"{surface}\", the only articular surface of {what} "
             "\"{name}\""}}),
      told("nodes-taken-as-bone", "Nothing, if these nodes are the bone.",
           {{N,
             "{nodes} {nodes?node is|nodes are} moved together (\"{body}\"): taken as a bone that the model leaves "
             "out"}}),
      told("symmetry-planes", "Nothing, if these are planes of symmetry.",
           {{N,
             "planes of symmetry, or walls without friction: {planes}; surfaces go on behind them as their mirror "
             "images, and forces, areas and loads are those of the part that is meshed"}}),
      told("facets-turned", "Nothing.",
           {{N,
             "surface \"{surface}\": {turned} of its {facets} facets have their nodes in the reverse order, facing "
             "into their elements: turned outwards"}}),
      told("shells-turned", "Nothing.",
           {{N, "surface \"{surface}\" lies on rigid shells and looked away from its partner: turned round"},
            {N,
             "surface \"{surface}\" lies on rigid shells, and {turned} of its {facets} facets looked away from its "
             "partner: turned round"}}),
      told("nodes-merged", "Nothing.",
           {{N,
             "surface \"{surface}\": {merged} of its {nodes} nodes lie where another one is and are taken for it, so "
             "that its facets join"}}),
      // ---- how settings and tables were taken
      told("frame", "Check the axes.", {{N, "frame \"{frame}\" in the model's axes: {x}, {y}, {z}"}}),
      told("placed", "Check the placement.",
           {{N, "body \"{body}\" is moved by ({x:g}, {y:g}, {z:g}){frame} before it starts"},
            {N,
             "body \"{body}\" is turned by {degrees:g} degrees about ({x:g}, {y:g}, {z:g}){frame} before it starts, "
             "through {center} ({center_x:.6g}, {center_y:.6g}, {center_z:.6g})"}}),
      told("value-set", "Nothing: you asked for it.",
           {{N, "set: {name}.{parameter} {value:.6g}{for} (model: {in_model}){controller}"}}),
      told("thickness-scaled", "Nothing: you asked for it.",
           {{N, "surface \"{surface}\": thickness times {factor:g} ({given})"}}),
      told("thickness-from-file", "Check the count of nodes.",
           {{N, "surface \"{surface}\": thickness from {file}, {nodes} nodes"},
            {N,
             "surface \"{surface}\": thickness from {file}, {nodes} nodes; {passed_over} of the file's nodes are not "
             "on it and passed over"}}),
      told("loads-table", "Check body and start.",
           {{N, "loads of {table}, on body \"{body}\", after the model's steps, each to its end"},
            {N, "loads of {table}, on body \"{body}\", from the starting poses, without the model's steps"}}),
      told("body-weight", "Check the unit.", {{N, "a body weight of {weight:g} is taken as it is; {doubt}"}}),
      told("loads-first-row", "Check direction and point of the first load.",
           {{N,
             "its first row in global axes: force ({force_x:.6g}, {force_y:.6g}, {force_z:.6g}), moment "
             "({moment_x:.6g}, {moment_y:.6g}, {moment_z:.6g}), at ({x:.6g}, {y:.6g}, {z:.6g}) of the body's reference "
             "position, its centre of mass{axes}"},
            {N,
             "its first row in global axes: force ({force_x:.6g}, {force_y:.6g}, {force_z:.6g}), moment "
             "({moment_x:.6g}, {moment_y:.6g}, {moment_z:.6g}), at ({x:.6g}, {y:.6g}, {z:.6g}) of the body's reference "
             "position{axes}"}}),
      told("table-without-effect", "Let the body move, or load another one.",
           {{N, "body \"{body}\" is not free to move at the end of the last step: the table's loads have no effect"},
            {N, "body \"{body}\" is not free to turn: the table's moments have no effect"}}),
      told("motion-table", "Check body, rotations and start.",
           {{N, "motion of {table}, of body \"{body}\"{rotations}{center}, after the model's steps, each to its end"},
            {N,
             "motion of {table}, of body \"{body}\"{rotations}{center}, from the starting poses, without the model's "
             "steps"}}),
      told("steps-skipped", "Nothing: you asked for it.",
           {{N, "the model's steps are not walked through: what holds at time {time} starts from the starting poses"}}),
      of_result("contacts-like-this",
                "Expect differences of this size from FEBio, no bounds; docs/accuracy.md says what was compared.",
                {{N,
                  "contact \"{contact}\": at time {time} it is like {contacts} contacts that FEBio solved too, in "
                  "width, strain, edges, moduli and facets: there p99 was {p99_least:+.1f} to "
                  "{p99_most:+.1f}%, mean {mean_least:+.1f} to {mean_most:+.1f}%, area {area_least:+.1f} to "
                  "{area_most:+.1f}% from FEBio's, whose contact gives way (automatic penalty 4); with that "
                  "in dea, too, p99 {series_p99_least:+.1f} to {series_p99_most:+.1f}%, mean {series_mean_least:+.1f} "
                  "to {series_mean_most:+.1f}%, area {series_area_least:+.1f} to "
                  "{series_area_most:+.1f}% (docs/accuracy.md)"},
                 {N,
                  "contact \"{contact}\": at time {time} it is like {contacts} contacts that FEBio solved too, in "
                  "width, strain, edges, moduli and facets: there, with the give of FEBio's contact "
                  "(automatic penalty 4) in dea, p99 was {p99_least:+.1f} to {p99_most:+.1f}%, mean {mean_least:+.1f} "
                  "to {mean_most:+.1f}%, area {area_least:+.1f} to {area_most:+.1f}% from FEBio's "
                  "(docs/accuracy.md)"}},
                contacts_like_this),
      told("step-seats-bones", "Skip the steps if the motion is not meant.",
           {{N,
             "step {step} moves body \"{body}\", and the last step lets it go: if it only seats the bones, as finite "
             "elements need, {skip} starts the last step without it, and solves its end alone where no table has "
             "rows"}}),
      told("states-thinned", "Name states to have others.",
           {{N,
             "of the model's {steps:.0f} time steps {solved} are solved, evenly chosen: each is an equilibrium of its "
             "own; others with {others}"},
            {N,
             "of the model's {steps:.0f} time steps {solved} are solved, evenly chosen besides ends of steps and must "
             "points: each is an equilibrium of its own; others with {others}"}}),
      told("states-left-out", "Nothing: you asked for these states.",
           {{N,
             "of the model's {steps:.0f} time steps only the states asked for and the ends of steps before them are "
             "followed, {solved} in all: each is an equilibrium of its own, or a motion that is given"}}),
      // ---- what asks nobody to act
      told("inside-unknown", "Use the layer law with two terms.",
           {{N,
             "inside: contact \"{contact}\" has not {need} of two terms with cartilage: nothing is known of its "
             "inside"}}),
      told("inside-without-elements", "Mesh the cartilage to see inside it.",
           {{N,
             "inside: contact \"{contact}\", surface \"{surface}\": its layer has no deformable elements in the model; "
             "stress and strain are told on the surface alone"}}),
      told("inside-elements", "Nothing.",
           {{N,
             "inside: contact \"{contact}\", surface \"{surface}\": {elements} elements of {parts}{rows}, their "
             "centroids at {lowest:.2f} to {highest:.2f} of the thickness above the bone"},
            {N,
             "inside: contact \"{contact}\", surface \"{surface}\": {elements} elements of {parts}{rows}, their "
             "centroids at {lowest:.2f} to {highest:.2f} of the thickness above the bone; {beside} lie beside it, and "
             "show 0 or what another contact does to them"}}),
      told("inside-unused", "Nothing.",
           {{N,
             "inside: {unused} of the model's {elements} deformable elements lie under no contact: their stress and "
             "strain are written as 0"}}),
      quiet_of_result(
          "incomplete-map", "Take numbers from the surface with springs.",
          {{N,
            "surface \"{surface}\": its pressure map is interpolated and carries {percent:.1f}% of the contact force"}},
          incomplete_map),
      quiet("facet-size", "Nothing: a warning tells where contact is narrow.",
            {{N,
              "contact \"{contact}\": its facets are up to {size:.2g} thicknesses long ({sizes}): force, p99 and peak "
              "are right to about 3%, area and mean to 5%, where contact is 8 facets wide, less where it is narrower; "
              "dea converge or {refine} tell"}}),
      quiet(
          "contact-shape", "Nothing: how far such contacts are from FEBio is in docs/accuracy.md.",
          {{N,
            "contact \"{contact}\": at time {time} it is {across:.1f} facets wide, {width:.2g} times as wide as its "
            "layers are thick, strained to {strain:.0f}%, with {edge:.0f}% of its force within one thickness of a free "
            "edge; moduli {ratio:.2g} to 1, nu {nu:.3g}"}}),
      quiet("shared-layer", "Nothing: they are solved together.",
            {{N, "contacts {contacts} press one layer of cartilage, surface {surfaces}: solved together"},
             {N, "contacts {contacts} press one layer of cartilage, surfaces {surfaces}: solved together"}}),
      quiet("compartments", "Nothing.",
            {{N, "surface \"{surface}\": {compartments:count} compartments that share no node: {compartments:comma}"}}),
      quiet("nearest-thickness-at-rim", "Nothing: usual at rims.",
            {{N,
              "surface \"{surface}\": at {count} of {vertices} vertices the thickness is the distance to the nearest "
              "point of the bone, for their normals meet no bone (usual at rims{shows_where})"}}),
      of_model("input-assumed", "Say it in the model if it is meant otherwise.",
               {{N, "{what}"}, {N, "{what} ({count} times)"}}, assumed_input),
      of_model("input-ignored", "Nothing: it does not change the joint.",
               {{I, "{what}"}, {I, "{what} ({count} times)"}, {I, "contact \"{contact}\": {what}"}}, ignored_input),
  };
}

/// Place in the order of telling, by code.
const std::map<std::string, std::size_t>& places() {
  static const std::map<std::string, std::size_t> all = [] {
    std::map<std::string, std::size_t> found;
    for (std::size_t i = 0; i < rules().size(); ++i) found[rules()[i].code] = i;
    return found;
  }();
  return all;
}

/// Warnings first, then in the order of the rules.
Findings in_order(Findings findings) {
  std::stable_sort(findings.begin(), findings.end(), [](const Finding& a, const Finding& b) {
    const Severity of_a = severity(a), of_b = severity(b);
    return of_a != of_b ? of_a > of_b : places().at(a.code) < places().at(b.code);
  });
  return findings;
}

}  // namespace

const std::vector<Rule>& rules() {
  static const std::vector<Rule> all = all_rules();
  return all;
}

const Rule* find_rule(const std::string& code) {
  const auto found = places().find(code);
  return found == places().end() ? nullptr : &rules()[found->second];
}

std::vector<std::string> rule_codes() {
  std::vector<std::string> codes;
  for (const Rule& rule : rules()) codes.emplace_back(rule.code);
  return codes;
}

Findings model_findings(const JointModel& model, const Joint& joint) {
  Findings findings = joint.findings;
  for (const Rule& rule : rules())
    if (rule.of_model != nullptr) add_once(findings, rule.of_model(model, joint));
  return in_order(std::move(findings));
}

Findings result_findings(const JointModel& model, const Joint& joint, const SolvedStates& result) {
  Findings findings;
  if (result.states.empty()) return findings;
  for (const Rule& rule : rules())
    if (rule.of_result != nullptr) add_once(findings, rule.of_result(model, joint, result));
  return in_order(std::move(findings));
}

Findings all_findings(const JointModel& model, const Joint& joint, const SolvedStates& result) {
  Findings findings = model_findings(model, joint);
  add_once(findings, result_findings(model, joint, result));
  return in_order(std::move(findings));
}

Findings warnings(const Findings& findings) {
  Findings found;
  for (const Finding& f : findings)
    if (severity(f) == Severity::Warning) found.push_back(f);
  return found;
}

Findings of_code(const Findings& findings, const std::string& code) {
  Findings found;
  for (const Finding& f : findings)
    if (f.code == code) found.push_back(f);
  return found;
}

}  // namespace dea
