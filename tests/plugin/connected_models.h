// tests/plugin/connected_models.h – small models of 4.0 with one load, joint or spring each.
#pragma once
#include <fmt/format.h>

#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/plugin/febio_runs.h"

namespace dea::test {

/// `block`'s model of 4.0, pressed by a force, with more in Rigid, as other sections, in LoadData and in the mesh.
struct Extra {
  std::string rigid = {}, sections = {}, controllers = {}, mesh = {};
  std::string held = "Rx Ry Ru Rv Rw";  ///< motions of the plate that are fixed
};

inline std::string pressed_model(const Extra& extra) {
  Parts p;
  p.more_mesh = extra.mesh;
  p.motion =
      R"(<rigid_load name="press" type="rigid_force"><rb>plate</rb><dof>Rz</dof><value lc="1">-6</value></rigid_load>
)" + extra.rigid;
  p.more = extra.sections;
  std::string text = model_40(false, p);
  const std::string all = "<Rx_dof>1</Rx_dof><Ry_dof>1</Ry_dof><Ru_dof>1</Ru_dof><Rv_dof>1</Rv_dof><Rw_dof>1</Rw_dof>";
  std::string held;
  std::istringstream words(extra.held);
  for (std::string word; words >> word;) held += fmt::format("<{0}_dof>1</{0}_dof>", word);
  text.replace(text.find("<rb>plate</rb>" + all) + 14, all.size(), held);
  const std::string end = "</LoadData>";
  text.insert(text.find(end), extra.controllers);
  return text;
}

inline std::string connector(const std::string& type, const std::string& inside) {
  return fmt::format(
      "<rigid_connector name=\"the {0}\" type=\"{0}\"><body_a>base</body_a><body_b>plate</body_b>{1}"
      "</rigid_connector>\n",
      type, inside);
}

inline std::string rigid_load(const std::string& type, const std::string& inside) {
  return fmt::format("<rigid_load name=\"the {0}\" type=\"{0}\">{1}</rigid_load>\n", type, inside);
}

inline std::string plate_motion(const std::string& type, const std::string& inside) {
  return fmt::format("<rigid_bc name=\"move\" type=\"{}\"><rb>plate</rb>{}</rigid_bc>\n", type, inside);
}

/// Springs of one material from the base to the plate.
inline Extra springs(const std::string& material) {
  return {"",
          fmt::format("<Discrete><discrete_material id=\"1\" name=\"s\" {}</discrete_material>"
                      "<discrete dmat=\"1\" discrete_set=\"strings\"/></Discrete>",
                      material),
          R"(<load_controller id="2" name="wave" type="math"><math> 1+0.3*sin(3*t) </math></load_controller>)",
          "<DiscreteSet name=\"strings\"><delem>1,19</delem><delem>3,20</delem></DiscreteSet>", "Rx Ry Rw"};
}

/// Loads, joints and springs as version 3.0 says them.
inline std::string connected_30() {
  std::string text = model_30(false);
  const auto put = [&](const std::string& before, const std::string& more) { text.insert(text.find(before), more); };
  put("<SurfacePair",
      "<NodeSet name=\"corner\"><n id=\"22\"/><n id=\"21\"/></NodeSet><DiscreteSet name=\"strings\">"
      "<delem>1,19</delem></DiscreteSet>");
  const std::string fixed = "<dofs>Rx,Ry,Ru,Rv,Rw</dofs>";
  text.replace(text.find(fixed), fixed.size(), "<dofs>Rx,Rv,Rw</dofs>");
  const std::string down = "<rigid_constraint name=\"c\" type=\"prescribe\"><rb>plate</rb><dof>Rz</dof>";
  text.replace(text.find(down), text.find("</Rigid>") - text.find(down), R"(
<rigid_constraint name="c" type="force"><rb>3</rb><dof>Rz</dof><value lc="1">-6</value></rigid_constraint>
<rigid_constraint name="d" type="force"><rb>3</rb><dof>Rz</dof><value>-2</value><load_type>2</load_type></rigid_constraint>
<rigid_constraint name="e" type="force"><rb>3</rb><dof>Ru</dof><value lc="1">0.3</value></rigid_constraint>
<rigid_constraint name="f" type="follower force"><rb>3</rb><insertion>1,1.3,0</insertion><force lc="1">0,0.1,-1</force></rigid_constraint>
<rigid_constraint name="g" type="follower moment"><rb>3</rb><moment lc="1">0.1,0,0</moment></rigid_constraint>
<rigid_connector name="m" type="rigid contractile force"><body_a>2</body_a><body_b>3</body_b><f0 lc="1">3</f0><insertion_a>1,1,-2</insertion_a><insertion_b>1,1,0.1</insertion_b></rigid_connector>
<rigid_connector name="p" type="rigid planar joint"><body_a>2</body_a><body_b>3</body_b><joint_origin>1,1,1</joint_origin><rotation_axis>1,0,0</rotation_axis><translation_axis_1>0,1,0</translation_axis_1><prescribed_translation_1>1</prescribed_translation_1><translation_1 lc="1">0.1</translation_1></rigid_connector>
)");
  put("<LoadData>",
      R"(<Loads><nodal_load name="n" type="nodal_load" node_set="corner"><dof>z</dof><scale lc="1">-0.5</scale></nodal_load></Loads>
<Discrete><discrete_material id="1" name="s" type="nonlinear spring"><scale>2</scale><force lc="1">2.5</force></discrete_material>
<discrete dmat="1" discrete_set="strings"/><rigid_axial_force><rbA>2</rbA><rbB>3</rbB><ra>1,1,-2</ra><rb>1.2,0.5,0</rb><force lc="1">1</force></rigid_axial_force></Discrete>
)");
  return text;
}

/// The same as version 2.5 says them.
inline std::string connected_25() {
  std::string text = model_25(false);
  const auto put = [&](const std::string& before, const std::string& more) { text.insert(text.find(before), more); };
  put("<SurfacePair",
      "<NodeSet name=\"corner\"><node id=\"22\"/><node id=\"21\"/></NodeSet><DiscreteSet name=\"strings\">"
      "<delem>1,19</delem></DiscreteSet>");
  const std::string fixed = R"(<rigid_body mat="3"><fixed bc="x"/><fixed bc="y"/><fixed bc="Rx"/><fixed bc="Ry"/>)";
  text.replace(text.find(fixed), fixed.size(), R"(<rigid_body mat="3"><fixed bc="x"/><fixed bc="Ry"/>
<force bc="z" lc="1">-6</force><force bc="z" type="ramp">-2</force><force bc="z" lc="1" type="follow">-1</force><force bc="Rx" lc="1">0.3</force>
)");
  const std::string down = R"(<prescribed bc="z" lc="1">-0.3</prescribed>)";
  text.replace(text.find(down), down.size(), "");
  put("<LoadData>", R"(<Loads><nodal_load bc="z" node_set="corner"><scale lc="1">-0.5</scale></nodal_load></Loads>
<Constraints><constraint name="m" type="rigid contractile force"><body_a>2</body_a><body_b>3</body_b><f0 lc="1">3</f0><insertion_a>1,1,-2</insertion_a><insertion_b>1,1,0.1</insertion_b></constraint>
<constraint name="p" type="rigid planar joint"><body_a>2</body_a><body_b>3</body_b><joint_origin>1,1,1</joint_origin><rotation_axis>1,0,0</rotation_axis><translation_axis_1>0,1,0</translation_axis_1><prescribed_translation_1>1</prescribed_translation_1><translation_1 lc="1">0.1</translation_1></constraint></Constraints>
<Discrete><discrete_material id="1" name="s" type="nonlinear spring"><scale>2</scale><force lc="1">2.5</force></discrete_material>
<discrete dmat="1" discrete_set="strings"/><rigid_axial_force><rbA>2</rbA><rbB>3</rbB><ra>1,1,-2</ra><rb>1.2,0.5,0</rb><force lc="1">1</force></rigid_axial_force></Discrete>
)");
  return text;
}

/// Every kind of load, joint, spring and controller that `dea run` takes, by what it is. Each is one that can be
/// solved.
inline std::vector<std::pair<std::string, std::string>> connected_models() {
  std::vector<std::pair<std::string, std::string>> models;
  const auto add = [&](const std::string& name, const Extra& extra) {
    models.emplace_back(name, pressed_model(extra));
  };
  const std::string math =
      R"(<load_controller id="2" name="wave" type="math"><math> 1+0.3*sin(3*t) </math></load_controller>)";
  const std::string spring = "<insertion_a>0.5,0,-2</insertion_a><insertion_b>0.5,0.2,1</insertion_b>";

  // joints
  const std::string origin = "<joint_origin>1,1,1</joint_origin>";
  add("prismatic", {connector("rigid prismatic joint",
                              origin + "<translation_axis>0,0,2</translation_axis>"
                                       "<transverse_axis>1,1,0</transverse_axis><force lc=\"1\">0.5</force>"),
                    "", "", "", "Rw"});
  add("revolute", {connector("rigid revolute joint",
                             "<joint_origin>-1,1.5,0.1</joint_origin>"
                             "<rotation_axis>0,1,0</rotation_axis><transverse_axis>1,0,0.5</transverse_axis>"
                             "<moment lc=\"1\">0.3</moment>"),
                   "", "", "", "Ry"});
  add("revolute_turned", {connector("rigid revolute joint",
                                    "<joint_origin>-4,1.5,0.1</joint_origin>"
                                    "<rotation_axis>0,1,0</rotation_axis><transverse_axis>1,0,0.5</transverse_axis>"
                                    "<prescribed_rotation>1</prescribed_rotation><rotation lc=\"1\">0.05</rotation>"),
                          "", "", "", "Ry"});
  add("cylindrical",
      {connector("rigid cylindrical joint",
                 origin + "<joint_axis>0,0,1</joint_axis>"
                          "<transverse_axis>1,0,0</transverse_axis><prescribed_rotation>1</prescribed_rotation>"
                          "<rotation lc=\"1\">0.1</rotation>"),
       "", "", "", ""});
  add("planar",
      {connector("rigid planar joint",
                 origin + "<rotation_axis>1,0,0</rotation_axis>"
                          "<translation_axis_1>0,1,0</translation_axis_1><prescribed_rotation>1</prescribed_rotation>"
                          "<prescribed_translation_1>1</prescribed_translation_1>"
                          "<translation_1 lc=\"1\">0.1</translation_1>"),
       "", "", "", ""});
  add("lock", {connector("rigid lock", origin + "<first_axis>1,0,0</first_axis><second_axis>0,1,0</second_axis>"), "",
               "", "", ""});
  add("spherical", {connector("rigid spherical joint",
                              "<joint_origin>1,1,3</joint_origin>"
                              "<moment_x lc=\"1\">0.1</moment_x><moment_y>0.2</moment_y>"),
                    "", "", "", "Rw"});
  add("spherical_turned",
      {connector("rigid spherical joint",
                 "<joint_origin>1,1,-6</joint_origin>"
                 "<prescribed_rotation>1</prescribed_rotation><rotation_x lc=\"1\">0.02</rotation_x>"),
       "", "", "", ""});
  add("old_joint", {connector("rigid joint", "<joint>1,1,3</joint><penalty>1</penalty>"), "", "", "", "Rw"});
  add("generic", {connector("generic rigid joint",
                            "<joint>1,1,1</joint><prescribe_x>0</prescribe_x>"
                            "<prescribe_y lc=\"1\">0.1</prescribe_y><prescribe_Rx>0</prescribe_Rx>"
                            "<prescribe_Ry>0</prescribe_Ry><prescribe_Rz lc=\"1\">0.1</prescribe_Rz>"),
                  "", "", "", ""});

  // muscles, cables, springs between bodies
  add("muscle", {connector("rigid contractile force", spring + "<f0 lc=\"2\">3</f0>"), "", math});
  const std::string axial = "<rbA>base</rbA><rbB>plate</rbB><ra>1,1,-2</ra><rb>1.2,0.5,0</rb><force lc=\"1\">4</force>";
  add("axial_force", {rigid_load("rigid_axial_force", axial)});
  add("axial_force_from_centers", {rigid_load("rigid_axial_force", axial + "<relative>1</relative>")});
  add("axial_force_in_discrete", {"", "<Discrete><rigid_axial_force>" + axial + "</rigid_axial_force></Discrete>"});
  const std::string cable =
      "<force lc=\"1\">2</force><force_direction>1,0,-3</force_direction>"
      "<rigid_cable_point><rigid_body_id>plate</rigid_body_id><position>1,1,2</position></rigid_cable_point>"
      "<rigid_cable_point><rigid_body_id>plate</rigid_body_id><position>3,1,1</position></rigid_cable_point>"
      "<rigid_cable_point><rigid_body_id>base</rigid_body_id><position>3,1,-3</position></rigid_cable_point>";
  add("cable", {rigid_load("rigid_cable", cable + "<relative>0</relative>")});
  add("cable_from_centers", {rigid_load("rigid_cable", cable)});
  add("cable_in_discrete", {"", "<Discrete><rigid_cable>" + cable + "</rigid_cable></Discrete>"});
  add("rigid_spring",
      {connector("rigid spring", spring + "<k>3</k><free_length>2</free_length>"), "", "", "", "Ru Rw"});

  // loads
  const std::string center = "<rb>plate</rb><dof>Rz</dof>";
  add("target", {rigid_load("rigid_force", center + "<value>-9</value><load_type>TARGET</load_type>")});
  add("follow", {rigid_load("rigid_force", center + "<value lc=\"2\">-2</value><load_type>FOLLOW</load_type>"), "",
                 math, "", "Rx Ry Rw"});
  add("relative", {rigid_load("rigid_force", center + "<value lc=\"1\">-2</value><relative>1</relative>")});
  add("moments",
      {rigid_load("rigid_moment", "<rb>plate</rb><dof>Ru</dof><value lc=\"1\">1</value>") +
           rigid_load("rigid_moment", "<rb>plate</rb><dof>Rv</dof><value>-1</value><load_type>TARGET</load_type>"),
       "", "", "", "Rx Ry Rw"});
  add("follower_force", {rigid_load("rigid_follower_force",
                                    "<rb>plate</rb><insertion>1,1.3,0</insertion>"
                                    "<force lc=\"1\">0,0.1,-2</force>"),
                         "", "", "", "Rx Ry Rw"});
  add("follower_force_from_center", {rigid_load("rigid_follower_force",
                                                "<rb>plate</rb><insertion>0.4,0.3,0</insertion>"
                                                "<force>0,0,-2</force><relative>1</relative>"),
                                     "", "", "", "Rx Ry Rw"});
  add("follower_moment",
      {rigid_load("rigid_follower_moment", "<rb>plate</rb><moment lc=\"1\">1,0.2,0</moment>"), "", "", "", "Rx Ry Rw"});
  const std::string corner = "<NodeSet name=\"corner\">22,21</NodeSet>";
  add("nodal_load", {"",
                     R"(<Loads><nodal_load name="one" type="nodal_load" node_set="corner"><dof>z</dof>)"
                     R"(<scale lc="1">-1</scale></nodal_load></Loads>)",
                     "", corner, "Rx Ry Rw"});
  add("nodal_force", {"",
                      R"(<Loads><nodal_load name="all" type="nodal_force" node_set="corner">)"
                      R"(<value lc="1">0.1,0,-1</value></nodal_load></Loads>)",
                      "", corner, "Rx Ry Rw"});

  // motions
  add("euler_angles", {plate_motion("rigid_euler_angles", "<Ex>1</Ex><Ey>-2</Ey><Ez>5</Ez>"), "", "", "", "Rx Ry"});
  add("euler_angle",
      {plate_motion("rigid_euler_angles", "<Ex>0</Ex><Ey lc=\"1\">-2</Ey><Ez>0</Ez>"), "", "", "", "Rx Ry"});
  add("rotation_vector",
      {plate_motion("rigid_rotation_vector", "<vx lc=\"1\">0.02</vx><vy>0</vy><vz lc=\"2\">0.1</vz>"), "", math, "",
       "Rx Ry"});
  const auto step = [&](int id, const std::string& inside) {
    return fmt::format(
        "<step id=\"{0}\" name=\"step{0}\">{1}<Rigid>{2}</Rigid></step>", id,
        "<Control><time_steps>2</time_steps><step_size>0.5</step_size><solver type=\"solid\"/></Control>", inside);
  };
  add("steps",
      {"",
       "<Step>" + step(1, plate_motion("rigid_displacement", "<dof>x</dof><value lc=\"1\">0.3</value>")) +
           step(2, plate_motion("rigid_displacement", "<dof>x</dof><value lc=\"1\">0.1</value><relative>1</relative>") +
                       connector("rigid contractile force", spring + "<f0>3</f0>") +
                       rigid_load("rigid_force", center + "<value>-3</value><relative>1</relative>")) +
           step(3, plate_motion("rigid_displacement", "<dof>x</dof><value>0.2</value>") +
                       rigid_load("rigid_force", center + "<value>-5</value><load_type>TARGET</load_type>")) +
           "</Step>",
       "", "", "Ry Ru Rv Rw"});

  // springs between nodes
  const auto add_springs = [&](const std::string& name, const std::string& material) {
    add("springs_" + name, springs(material));
  };
  add_springs("linear", "type=\"linear spring\"><E>3</E>");
  add_springs("tension_only", "type=\"tension-only linear spring\"><E>3</E>");
  add_springs("experimental", "type=\"experimental spring\"><E>3</E><sM>0.5</sM><sm>0.2</sm>");
  const std::string points = "<points><pt>-1,-1</pt><pt>0,0</pt><pt>0.1,0.5</pt><pt>1,3</pt></points>";
  add_springs("points",
              "type=\"nonlinear spring\"><force type=\"point\"><interpolate>SMOOTH</interpolate>"
              "<extend>EXTRAPOLATE</extend>" +
                  points + "</force>");
  add_springs("strain",
              "type=\"nonlinear spring\"><scale lc=\"2\">2</scale><measure>strain</measure>"
              "<force type=\"point\">" +
                  points + "</force>");
  add_springs("math",
              "type=\"nonlinear spring\"><measure>stretch</measure><force type=\"math\"><math>x^2-1</math></force>");
  add_springs(
      "ramp",
      "type=\"nonlinear spring\"><force type=\"linear ramp\"><slope>2</slope><intercept>0.1</intercept></force>");
  add_springs("constant", "type=\"nonlinear spring\"><force type=\"const\"><value>0.2</value></force>");
  add_springs("curve", "type=\"nonlinear spring\"><force lc=\"1\">2.5</force>");
  models.emplace_back("version_25", connected_25());
  models.emplace_back("version_30", connected_30());
  add("materials", {"", "", "", "", "Rx Ry Ru Rv Rw"});
  std::string& text = models.back().second;
  const std::string number = "<E>10</E>";
  text.replace(text.find(number), number.size(), "<E type=\"math\">2*(3+2)</E>");
  return models;
}

/// What DEA refuses, whoever reads it, by what it is.
inline std::vector<std::pair<std::string, std::string>> refused_models() {
  std::vector<std::pair<std::string, std::string>> models;
  const auto add = [&](const std::string& name, const Extra& extra) {
    models.emplace_back(name, pressed_model(extra));
  };
  const auto controller = [](const std::string& inside) {
    return Extra{"", "", "<load_controller id=\"2\" name=\"c\" " + inside + "</load_controller>", "", ""};
  };
  const auto used = [](Extra extra) {
    extra.rigid = rigid_load("rigid_force", "<rb>plate</rb><dof>Rz</dof><value lc=\"2\">-2</value>");
    return extra;
  };
  const std::string revolute = "<joint_origin>1,1,1</joint_origin><rotation_axis>0,1,0</rotation_axis>";
  const auto joint = [&](const std::string& type, const std::string& inside) {
    return Extra{connector(type, inside), "", "", "", "Ry"};
  };
  add("torsion", joint("rigid revolute joint", revolute + "<torsion_stiffness>3</torsion_stiffness>"));
  add("lagrange_moment", joint("rigid revolute joint", revolute + "<moment>1</moment><laugon>LAGMULT</laugon>"));
  add("lagrange_rotation", joint("rigid revolute joint", revolute + "<prescribed_rotation>1</prescribed_rotation>"
                                                                    "<rotation>1</rotation><laugon>LAGMULT</laugon>"));
  add("spherical_on_turning", {connector("rigid spherical joint", "<prescribed_rotation>1</prescribed_rotation>") +
                               "<rigid_bc name=\"turn\" type=\"rigid_rotation\"><rb>base</rb><dof>Ru</dof>"
                               "<value>0.1</value></rigid_bc>"});
  add("generic_mixed", joint("generic rigid joint", "<joint>1,1,1</joint><prescribe_Rx>0.1</prescribe_Rx>"));
  add("generic_far", joint("generic rigid joint",
                           "<joint>1,1,1</joint><prescribe_Rx>2</prescribe_Rx>"
                           "<prescribe_Ry>0</prescribe_Ry><prescribe_Rz>0</prescribe_Rz>"));
  add("moving_joint", joint("rigid lock",
                            "<joint_origin lc=\"1\">1,1,1</joint_origin><first_axis>1,0,0</first_axis>"
                            "<second_axis>0,1,0</second_axis>"));
  add("moving_muscle", joint("rigid contractile force", "<insertion_a lc=\"1\">1,1,1</insertion_a><f0>1</f0>"));
  add("moving_cable", {rigid_load("rigid_cable",
                                  "<force>1</force><rigid_cable_point><rigid_body_id>plate"
                                  "</rigid_body_id><position lc=\"1\">1,1,1</position></rigid_cable_point>")});
  add("changing_spring", joint("rigid spring", "<k lc=\"1\">3</k>"));
  add("follower_moment", {rigid_load("rigid_moment",
                                     "<rb>plate</rb><dof>Ru</dof><value>1</value>"
                                     "<load_type>FOLLOW</load_type>")});
  add("euler_angles", {plate_motion("rigid_euler_angles", "<Ex lc=\"1\">1</Ex><Ey>2</Ey>"), "", "", "", "Rx"});
  add("var", used(controller("type=\"math\"><var>fem.time</var><math>var_0+t</math>")));
  add("word", used(controller("type=\"math\"><math>t+pressure</math>")));
  add("pid", used(controller("type=\"PID\"><target>1</target>")));
  add("times", used(controller("type=\"loadcurve\"><points><pt>0,1</pt><pt>2,1</pt><pt>1,0</pt></points>")));
  add("hill", springs("type=\"Hill\"><Fmax>1</Fmax>"));
  add("torsion_spring", springs("type=\"torsion spring\"><r>1</r>"));
  add("changing_E", springs("type=\"linear spring\"><E lc=\"1\">3</E>"));
  add("logarithm", springs("type=\"nonlinear spring\"><force type=\"point\"><log>1</log><points><pt>1,1</pt>"
                           "<pt>2,1</pt></points></force>"));
  add("step", springs("type=\"nonlinear spring\"><force type=\"step\"><x0>1</x0></force>"));
  add("two_variables", springs("type=\"nonlinear spring\"><force type=\"math\"><math>x+y</math></force>"));
  const std::string corner = "<NodeSet name=\"corner\">22,21</NodeSet>";
  const auto nodal = [&](const std::string& type, const std::string& inside) {
    return Extra{
        "",
        "<Loads><nodal_load name=\"n\" type=\"" + type + "\" node_set=\"corner\">" + inside + "</nodal_load></Loads>",
        "", corner};
  };
  add("nodal_map", nodal("nodal_load", "<dof>z</dof><scale type=\"math\">X*2</scale>"));
  add("nodal_relative", nodal("nodal_load", "<dof>z</dof><scale>1</scale><relative>1</relative>"));
  add("nodal_target", nodal("nodal_target_force", "<force>1,0,0</force>"));
  add("pressure", {"",
                   "<Loads><surface_load name=\"p\" type=\"pressure\" surface=\"under\"><pressure>1</pressure>"
                   "</surface_load></Loads>"});
  add("weight", {"", "<Loads><body_load name=\"g\" type=\"body force\"><force>0,0,-1</force></body_load></Loads>"});
  const auto moved = [&](const std::string& nodes) {
    return Extra{"",
                 "<Boundary><bc name=\"up\" type=\"prescribed displacement\" node_set=\"moved\"><dof>z</dof>"
                 "<value lc=\"1\">1</value></bc></Boundary>",
                 "", "<NodeSet name=\"moved\">" + nodes + "</NodeSet>"};
  };
  add("moved_body", moved("19,20"));
  add("moved_nodes", moved("10,11"));
  return models;
}

}  // namespace dea::test
