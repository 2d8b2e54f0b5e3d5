#include "io/feb/read_feb.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <random>
#include <set>
#include <sstream>

#include "src/base/error.h"
#include "src/model/load_curve.h"

namespace dea::read_feb_test {

namespace fs = std::filesystem;

/// A folder of its own for each test, gone afterwards.
class ReadFeb : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / fmt::format("dea_feb_{}_{}",
                                                      testing::UnitTest::GetInstance()->current_test_info()->name(),
                                                      std::random_device()());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) const {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return (folder_ / name).string();
  }
  JointModel read(const std::string& text) const { return read_feb(write("model.feb", text)); }
  /// The message without the folder.
  std::string fault(const std::string& path) const {
    try {
      read_feb(path);
    } catch (const InputError& error) {
      std::string text = error.what();
      const std::string prefix = folder_.string() + "/";
      for (std::size_t at = text.find(prefix); at != text.npos; at = text.find(prefix)) text.erase(at, prefix.size());
      return text;
    }
    return "read without a fault";
  }
  std::string fault_of(const std::string& text) const { return fault(write("model.feb", text)); }
  fs::path folder_;
};

std::string feb(const std::string& version, const std::string& sections) {
  return "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>\n<febio_spec version=\"" + version + "\">\n" + sections +
         "</febio_spec>\n";
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, text.npos) << "the model does not contain " << from;
  return at == text.npos ? text : text.replace(at, from.size(), to);
}

// -- one model, three formats -------------------------------------------------------------------------

// Two cubes on top of each other with a gap: a layer held by a rigid plate (shell), another by a rigid node set.
const std::string kMaterials = R"(<Material>
<material id="1" name="plate" type="rigid body"><density>2</density><center_of_mass>0,0,0</center_of_mass></material>
<material id="2" name="lower" type="neo-Hookean"><E>10</E><v>0.4</v></material>
<material id="3" name="upper" type="biphasic"><phi0>0.2</phi0><solid type="Holmes-Mow"><E>5</E><v>0.1</v></solid></material>
<material id="4" name="femur" type="rigid body"/>
</Material>
)";
const std::string kNodes = R"(<Nodes name="all">
<node id="1">0,0,0</node><node id="2">1,0,0</node><node id="3">1,1,0</node><node id="4">0,1,0</node>
<node id="5">0,0,1</node><node id="6">1,0,1</node><node id="7">1,1,1</node><node id="8">0,1,1</node>
<node id="11">0,0,1.5</node><node id="12">1,0,1.5</node><node id="13">1,1,1.5</node><node id="14">0,1,1.5</node>
<node id="15">0,0,2.5</node><node id="16">1,0,+2.5</node><node id="17"> 1, 1, 2.5 </node><node id="18">0,1,25e-1</node>
</Nodes>
)";
const std::string kSurfaces = R"(<Surface name="bottom"><quad4 id="1">5,6,7,8</quad4></Surface>
<Surface name="top"><tri3 id="1">11,13,12</tri3><tri3 id="2">11,14,13</tri3></Surface>
)";
const std::string kSets25 =
    R"(<NodeSet name="held"><node id="18"/><node id="17"/><node id="15"/><node id="16"/></NodeSet>
<NodeSet name="side"><node_list>1,5:8:3</node_list></NodeSet>
<DiscreteSet name="ligament"><delem>1,18</delem></DiscreteSet>
)";
const std::string kCurves25 =
    R"(<LoadData><loadcurve id="1" type="smooth" extend="repeat offset"><loadpoint>0,0</loadpoint><loadpoint>1,1</loadpoint></loadcurve>
<loadcurve id="2" type="step"><point>0.5,1</point><point>1.5,1</point></loadcurve></LoadData>
)";
const std::string kCurves =
    R"(<LoadData><load_controller id="1" type="loadcurve"><interpolate>SMOOTH</interpolate><extend>REPEAT OFFSET</extend>
<points><point>0,0</point><point>1,1</point></points></load_controller>
<load_controller id="2" type="loadcurve"><interpolate>1</interpolate><points><pt>0.5,1</pt><pt>1.5,1</pt></points></load_controller></LoadData>
)";
const std::string kDiscrete =
    R"(<Discrete><discrete_material id="1" name="s" type="linear spring"><E>3</E></discrete_material>
<discrete_material id="2" name="t" type="tension-only linear spring"><E>4</E></discrete_material>
<discrete dmat="2" discrete_set="ligament"/></Discrete>
)";
const std::string kContact = R"(<Contact><contact name="joint" type="sliding-elastic" surface_pair="pair">
<penalty>20</penalty><fric_coeff>0.2</fric_coeff><search_radius>1</search_radius><tension>0</tension></contact></Contact>
)";
const std::string kMesh30 =
    "<Mesh>" + kNodes + R"(<Elements type="hex8" name="L"><elem id="1">1,2,3,4,5,6,7,8</elem></Elements>
<Elements type="hex8" name="U"><elem id="2">11,12,13,14,15,16,17,18</elem></Elements>
<Elements type="quad4" name="P"><elem id="3">1,4,3,2</elem></Elements>
)" + kSurfaces;
const std::string kDomains = R"(<MeshDomains><SolidDomain name="L" mat="lower"/><SolidDomain name="U" mat="upper"/>
<ShellDomain name="P" mat="plate"><shell_thickness>0.5</shell_thickness></ShellDomain></MeshDomains>
)";
const std::string kPair30 =
    R"(<SurfacePair name="pair"><primary>bottom</primary><secondary>top</secondary></SurfacePair>
<DiscreteSet name="ligament"><delem>1,18</delem></DiscreteSet></Mesh>
)";

const std::string kModel25 = feb(
    "2.5",
    R"(<Module type="biphasic"><units>mm-N-s</units></Module>
<Control><time_steps>4</time_steps><step_size>0.25</step_size><analysis type="static"/></Control>
)" + kMaterials +
        "<Geometry>" + kNodes + R"(<Elements type="hex8" mat="2" name="L"><elem id="1">1,2,3,4,5,6,7,8</elem></Elements>
<Elements type="HEX8G8" mat="upper" name="U"><elem id="2">11,12,13,14,15,16,17,18</elem></Elements>
<Elements type="q4eas" mat="plate" name="P"><elem id="3">1,4,3,2</elem></Elements>
)" + kSurfaces +
        kSets25 + R"(<SurfacePair name="pair"><master surface="top"/><slave surface="bottom"/></SurfacePair>
</Geometry>
<MeshData><ElementData var="shell thickness" elem_set="P"><elem lid="1">0.5,0.5,0.5,0.5</elem></ElementData></MeshData>
<Boundary><fix bc="x,z" node_set="side"/><rigid rb="4" node_set="held"/>
<rigid_body mat="1"><fixed bc="x"/><fixed bc="Rx"/></rigid_body></Boundary>
)" + kContact +
        R"(<Constraints><constraint name="c" type="rigid spring"><body_a>1</body_a><body_b>femur</body_b><k>7</k>
<insertion_a>0,0,0</insertion_a><insertion_b>0,0,3</insertion_b></constraint></Constraints>
)" + kDiscrete +
        R"(<Step name="one"><Boundary><rigid_body mat="4"><prescribed bc="z" lc="1">-0.1</prescribed></rigid_body></Boundary></Step>
<Step name="two"><Control><time_steps>10</time_steps><step_size>0.1</step_size><time_stepper><dtmax lc="2"></dtmax></time_stepper></Control>
<Boundary><rigid_body mat="4"><force bc="Rz" lc="1">-50</force><force bc="x" lc="2" type="follow">1</force></rigid_body></Boundary></Step>
)" + kCurves25);

const std::string kModel30 = feb("3.0", R"(<Module type="biphasic"><units>mm-N-s</units></Module>
<Control><analysis>STATIC</analysis><time_steps>4</time_steps><step_size>0.25</step_size></Control>
)" + kMaterials + kMesh30 + R"(<NodeSet name="held"><n id="18"/><n id="17"/><n id="15"/><n id="16"/></NodeSet>
<NodeSet name="side"><n id="1"/><n id="5"/><n id="8"/></NodeSet>
)" + kPair30 + replaced(kDomains, "<shell_thickness>0.5</shell_thickness>", "") +
                                            R"(
<MeshData><ElementData var="shell thickness" elem_set="P"><elem lid="1">0.5,0.5,0.5,0.5</elem></ElementData></MeshData>
<Boundary><bc type="fix" node_set="side"><dofs>x,z</dofs></bc><bc type="rigid" node_set="held"><rb>4</rb></bc></Boundary>
<Rigid><rigid_constraint type="fix"><rb>1</rb><dofs>Rx,Ru</dofs></rigid_constraint>
<rigid_connector name="c" type="rigid spring"><body_a>1</body_a><body_b>4</body_b><k>7</k>
<insertion_a>0,0,0</insertion_a><insertion_b>0,0,3</insertion_b></rigid_connector></Rigid>
)" + kContact + kDiscrete + R"(<Step><step id="1" name="one">
<Rigid><rigid_constraint type="prescribe"><rb>femur</rb><dof>Rz</dof><value lc="1">-0.1</value></rigid_constraint></Rigid></step>
<step id="2" name="two"><Control><time_steps>10</time_steps><step_size>0.1</step_size><time_stepper><dtmax lc="2">0</dtmax></time_stepper></Control>
<Rigid><rigid_constraint type="force"><rb>4</rb><dof>Rw</dof><value lc="1">-50</value><load_type>0</load_type></rigid_constraint>
<rigid_constraint type="force"><rb>4</rb><dof>0</dof><value lc="2">1</value><load_type>1</load_type></rigid_constraint></Rigid></step></Step>
)" + kCurves);

const std::string kModel40 = feb(
    "4.0",
    R"(<Module type="biphasic"><units>mm-N-s</units></Module>
<Control><analysis>STATIC</analysis><time_steps>4</time_steps><step_size>0.25</step_size></Control>
)" + kMaterials +
        kMesh30 + R"(<NodeSet name="held">18, 17, 15,
16</NodeSet><NodeSet name="side">1,5:8:3</NodeSet>
)" + kPair30 +
        kDomains +
        R"(<Boundary><bc type="zero displacement" node_set="side"><x_dof>1</x_dof><y_dof>0</y_dof><z_dof>1</z_dof></bc>
<bc type="rigid" node_set="held"><rb>femur</rb><clamp_shells>1</clamp_shells></bc></Boundary>
<Rigid><rigid_bc type="rigid_fixed"><rb>plate</rb><Rx_dof>1</Rx_dof><Ru_dof>1</Ru_dof></rigid_bc>
<rigid_connector name="c" type="rigid spring"><body_a>plate</body_a><body_b>femur</body_b><k>7</k>
<insertion_a>0,0,0</insertion_a><insertion_b>0,0,3</insertion_b><free_length>0</free_length></rigid_connector></Rigid>
)" + kContact +
        kDiscrete + R"(<Step><step id="1" name="one">
<Rigid><rigid_bc type="rigid_displacement"><rb>femur</rb><dof>z</dof><value lc="1">-0.1</value><relative>0</relative></rigid_bc></Rigid></step>
<step id="2" name="two"><Control><time_steps>10</time_steps><step_size>0.1</step_size><time_stepper><dtmax lc="2">0</dtmax></time_stepper></Control>
<Rigid><rigid_load type="rigid_moment"><rb>femur</rb><dof>Rw</dof><value lc="1">-50</value></rigid_load>
<rigid_load type="rigid_force"><rb>femur</rb><dof>Rx</dof><value lc="2">1</value><load_type>FOLLOW</load_type></rigid_load></Rigid></step></Step>
)" + kCurves);

// The same in 2.0 and 1.2: facets, nodes and springs where they are used; x, y, z and rotations in other words.
const std::string kOldContactParameters =
    "<penalty>20</penalty><fric_coeff>0.2</fric_coeff><search_radius>1</search_radius><tension>0</tension>";
const std::string kModel20 =
    feb("2.0",
        R"(<Module type="biphasic"><units>mm-N-s</units></Module>
<Control><time_steps>4</time_steps><step_size>0.25</step_size><analysis type="static"/></Control>
)" + kMaterials +
            "<Geometry>" + replaced(kNodes, "<Nodes name=", "<Nodes set=") +
            R"(<Elements type="hex8" mat="2" elset="L"><elem id="1">1,2,3,4,5,6,7,8</elem></Elements>
<Elements type="hex8" mat="upper" elset="U"><elem id="2">11,12,13,14,15,16,17,18</elem></Elements>
<Elements type="quad4" mat="1" elset="P"><elem id="3">1,4,3,2</elem></Elements>
<Surface name="bottom"><quad4 id="1">5,6,7,8</quad4></Surface>
<NodeSet name="end"><node id="8"/></NodeSet><NodeSet name="pair"><node id="1"/><node id="2"/></NodeSet><NodeSet name="side"><node id="1"/><node id="5"/><NodeSet set="end"/></NodeSet>
<ElementData><element id="3"><thickness>0.5,0.5,0.5,0.5</thickness></element></ElementData></Geometry>
<Boundary><fix bc="x" set="side"/><fix bc="z"><node id="1"/><node id="5"/><node id="8"/></fix></Boundary>
<Contact><contact type="rigid"><node id="18" rb="4"/><node id="17" rb="4"/><node id="15" rb="4"/><node id="16" rb="4"/></contact>
<contact name="joint" type="sliding-elastic">)" +
            kOldContactParameters +
            R"(<surface type="master"><tri3 id="1">11,13,12</tri3><tri3 id="2">11,14,13</tri3></surface>
<surface type="slave" set="bottom"/></contact></Contact>
<Constraints><rigid_body mat="1"><fixed bc="x"/><fixed bc="Rx"/></rigid_body>
<constraint name="c" type="rigid spring"><body_a>1</body_a><body_b>4</body_b><k>7</k>
<insertion_a>0,0,0</insertion_a><insertion_b>0,0,3</insertion_b></constraint></Constraints>
<Discrete><spring type="tension-only linear"><node>1,18</node><E>4</E></spring></Discrete>
<Step name="one"><Constraints><rigid_body mat="4"><prescribed bc="z" lc="1">-0.1</prescribed></rigid_body></Constraints></Step>
<Step name="two"><Module type="biphasic"/><Control><time_steps>10</time_steps><step_size>0.1</step_size><time_stepper><dtmax lc="2"></dtmax></time_stepper></Control>
<Constraints><rigid_body mat="4"><force bc="Rz" lc="1">-50</force><force bc="x" lc="2" type="follow">1</force></rigid_body></Constraints></Step>
)" + kCurves25);
const std::string kModel12 = feb(
    "1.2",
    R"(<Module type="biphasic"><units>mm-N-s</units></Module>
<Control><time_steps>4</time_steps><step_size>0.25</step_size><analysis type="static"/></Control>
)" + kMaterials +
        "<Geometry>" + replaced(kNodes, "<Nodes name=", "<Nodes set=") +
        R"(<Elements><hex8 id="7" mat="2">1,2,3,4,5,6,7,8</hex8><quad4 id="8" mat="1">1,4,3,2</quad4>
<hex8 id="9" mat="3">11,12,13,14,15,16,17,18</hex8></Elements>
<ElementData><element id="2"><thickness>0.5,0.5,0.5,0.5</thickness></element></ElementData></Geometry>
<Boundary><fix><node id="1" bc="xz"/><node id="5" bc="xz"/><node id="8" bc="xz"/></fix>
<contact type="rigid"><node id="18" rb="4"/><node id="17" rb="4"/><node id="15" rb="4"/><node id="16" rb="4"/></contact>
<contact type="rigid spring"><body_a>1</body_a><body_b>4</body_b><k>7</k>
<insertion_a>0,0,0</insertion_a><insertion_b>0,0,3</insertion_b></contact>
<contact type="sliding-elastic">)" +
        kOldContactParameters +
        R"(<surface type="master" format="face nodes"><tri3 id="1">11,13,12</tri3><tri3 id="2">11,14,13</tri3></surface>
<surface type="slave" format="element face"><quad4 id="1">1,6</quad4></surface></contact>
<spring type="tension-only linear"><node>1,18</node><E>4</E></spring></Boundary>
<Constraints><rigid_body mat="1"><trans_x type="fixed"/><rot_x type="fixed"/></rigid_body></Constraints>
<Step name="one"><Constraints><rigid_body mat="4"><trans_z type="prescribed" lc="1" relative="false">-0.1</trans_z></rigid_body></Constraints></Step>
<Step name="two"><Control><time_steps>10</time_steps><step_size>0.1</step_size><time_stepper><dtmax lc="2"></dtmax></time_stepper></Control>
<Constraints><rigid_body mat="4"><rot_z type="force" lc="1">-50</rot_z><trans_x type="force" lc="2">1</trans_x></rigid_body></Constraints></Step>
)" + kCurves25);

/// Everything a model says, one line each, without names of conditions, places and what formats count differently.
using Facts = std::map<std::string, std::multiset<std::string>>;

std::string list(const std::vector<int>& numbers) { return fmt::format("{}", fmt::join(numbers, " ")); }

Facts facts_of(const JointModel& m) {
  Facts facts;
  const auto curve = [&](const Scaled& s) {
    std::string text = fmt::format("{:.9g}", s.factor);
    if (s.controller < 0) return text;
    const LoadController& c = m.controllers[static_cast<std::size_t>(s.controller)];
    text += fmt::format(" curve {} {} {}", static_cast<int>(c.interpolate), static_cast<int>(c.extend), c.unsupported);
    for (const auto& p : c.points) text += fmt::format(" ({:g},{:g})", p[0], p[1]);
    return text;
  };
  // Facets as a set, each from its lowest corner: FEBio Studio starts them elsewhere from format to format.
  const auto surface = [&](int index) {
    const Surface& s = m.surfaces[static_cast<std::size_t>(index)];
    std::multiset<std::string> facets;
    for (std::size_t i = 0; i + 1 < s.begin.size(); ++i) {
      std::vector<int> nodes(s.nodes.begin() + s.begin[i], s.nodes.begin() + s.begin[i + 1]);
      const auto corners = static_cast<std::ptrdiff_t>(nodes.size() == 3 || nodes.size() == 6 ? 3 : 4);
      const auto turn = std::min_element(nodes.begin(), nodes.begin() + corners) - nodes.begin();
      std::rotate(nodes.begin(), nodes.begin() + turn, nodes.begin() + corners);
      if (nodes.size() > static_cast<std::size_t>(corners)) {
        std::rotate(nodes.begin() + corners, nodes.begin() + corners + turn, nodes.begin() + 2 * corners);
      }
      facets.insert(list(nodes));
    }
    return fmt::format("{}", fmt::join(facets, ", "));
  };
  const auto sorted = [](std::vector<int> nodes) {
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    return list(nodes);
  };
  for (std::size_t i = 0; i < m.nodes.size(); ++i) {
    facts["nodes"].insert(
        fmt::format("{} {:.6g} {:.6g} {:.6g}", m.node_ids[i], m.nodes[i].x(), m.nodes[i].y(), m.nodes[i].z()));
  }
  for (const Domain& d : m.domains) {
    facts["elements"].insert(fmt::format("{} material {}: {}", static_cast<int>(d.shape), d.material, list(d.nodes)));
    double thickest = 0;
    for (const double t : d.shell_thickness) thickest = std::max(thickest, t);
    facts["thickness"].insert(fmt::format("{} {:g}", &d - m.domains.data(), thickest));
  }
  for (const Material& a : m.materials) {
    facts["materials"].insert(fmt::format("{} {} {:g} {:g} {:g} {}", a.id, a.type, a.density, a.E, a.nu, a.note));
    facts["material names"].insert(fmt::format("{} {}", a.id, a.name));
    facts["com"].insert(a.center_of_mass ? fmt::format("{} {:g} {:g} {:g}", a.id, a.center_of_mass->x(),
                                                       a.center_of_mass->y(), a.center_of_mass->z())
                                         : "");
  }
  for (const RigidFixed& f : m.rigid_fixed) {
    for (int i = 0; i < kDofs; ++i) {
      if (f.dofs[static_cast<std::size_t>(i)])
        facts["rigid fixed"].insert(fmt::format("{} {} step {}", f.material, kDofNames[i], f.step));
    }
  }
  for (const RigidPrescribed& p : m.rigid_prescribed) {
    facts["rigid prescribed"].insert(
        fmt::format("{} {} {} {} step {}", p.material, kDofNames[p.dof], curve(p.value), p.relative, p.step));
  }
  for (const RigidLoad& l : m.rigid_loads) {
    facts["rigid loads"].insert(fmt::format("{} {} {} {} step {}", l.material, kDofNames[l.dof], curve(l.value),
                                            static_cast<int>(l.kind), l.step));
  }
  for (const RigidSpring& s : m.rigid_springs) {
    facts["rigid springs"].insert(fmt::format("{} {} {:g} {:g} {:g}", s.material_a, s.material_b, s.k, s.free_length,
                                              (s.insertion_b - s.insertion_a).norm()));
  }
  for (const RigidJoint& j : m.rigid_joints) {
    std::string text = fmt::format("{} {} {} at {:g} {:g} {:g} step {}:", j.type, j.material_a, j.material_b,
                                   j.joint_origin.x(), j.joint_origin.y(), j.joint_origin.z(), j.step);
    for (std::size_t i = 0; i < 6; ++i) text += fmt::format(" {} {}", static_cast<int>(j.motion[i]), curve(j.value[i]));
    for (int i = 0; i < 9; ++i) text += fmt::format(" {:.6g}", j.axes(i / 3, i % 3) + 0.0);
    facts["joints"].insert(text);
  }
  for (const RigidAxialForce& f : m.rigid_axial_forces) {
    facts["axial forces"].insert(fmt::format("{} {} {:g} {} {} step {}", f.material_a, f.material_b,
                                             (f.point_b - f.point_a).norm(), f.from_centers, curve(f.force), f.step));
  }
  for (const NodalForce& f : m.nodal_forces) {
    facts["nodal forces"].insert(fmt::format("{:g} {:g} {:g} {} step {}: {}", f.value.x(), f.value.y(), f.value.z(),
                                             curve({1.0, f.controller}), f.step, sorted(f.nodes)));
  }
  for (const DiscreteSprings& s : m.discrete_springs) {
    std::string pairs;
    for (const auto& p : m.discrete_sets[static_cast<std::size_t>(s.set)].pairs)
      pairs += fmt::format(" {}-{}", p[0], p[1]);
    facts["springs"].insert(fmt::format("{:g} {} {}", s.stiffness, s.tension_only, pairs));
  }
  // Old formats list nodes where others name sets, so one set may be several lists.
  std::map<std::string, std::vector<int>> held, carried, moved;
  const auto append = [](std::vector<int>& to, const std::vector<int>& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  for (const FixedNodes& f : m.fixed_nodes) {
    for (std::size_t i = 0; i < 3; ++i) {
      if (f.xyz[i]) append(held[fmt::format("{} step {}", "xyz"[i], f.step)], f.nodes);
    }
  }
  for (const PrescribedNodes& p : m.prescribed_nodes)
    append(moved[fmt::format("{} {} {} step {}", "xyz"[p.component], curve(p.value), p.relative, p.step)], p.nodes);
  for (const RigidNodes& r : m.rigid_nodes) append(carried[fmt::format("{} step {}", r.material, r.step)], r.nodes);
  for (const auto& nodes : held) facts["fixed"].insert(nodes.first + ": " + sorted(nodes.second));
  for (const auto& nodes : moved) facts["moved nodes"].insert(nodes.first + ": " + sorted(nodes.second));
  for (const auto& nodes : carried) facts["rigid nodes"].insert(nodes.first + ": " + sorted(nodes.second));
  for (const Contact& c : m.contacts) {
    facts["contacts"].insert(fmt::format("{} {:g} step {}: {} | {}", static_cast<int>(c.kind), c.max_distance, c.step,
                                         surface(c.primary), surface(c.secondary)));
    facts["contact parameters"].insert(fmt::format("{} {}", c.type, fmt::join(c.ignored, ", ")));
  }
  for (const Step& s : m.steps)
    facts["steps"].insert(fmt::format("{:g} {:g} must {}", s.duration, s.step_size, fmt::join(s.must_points, " ")));
  facts["module"].insert(m.module + " " + m.units);
  return facts;
}

/// Differences as text, empty if there are none.
std::string differences(const Facts& a, const Facts& b, const std::set<std::string>& except = {}) {
  std::set<std::string> keys;
  for (const auto& entry : a) keys.insert(entry.first);
  for (const auto& entry : b) keys.insert(entry.first);
  std::string text;
  for (const std::string& key : keys) {
    const auto of = [&](const Facts& facts) {
      return facts.count(key) > 0 ? facts.at(key) : std::multiset<std::string>();
    };
    const std::multiset<std::string> left = of(a), right = of(b);
    if (left == right || except.count(key) > 0) continue;
    text += "\n  " + key + ":";
    for (const std::string& line : left) {
      if (right.count(line) == 0) text += "\n    - " + line.substr(0, 300);
    }
    for (const std::string& line : right) {
      if (left.count(line) == 0) text += "\n    + " + line.substr(0, 300);
    }
  }
  return text;
}

TEST_F(ReadFeb, OneModelInFiveFormatsIsTheSame) {
  const JointModel m25 = read(kModel25), m30 = read(kModel30), m40 = read(kModel40);
  EXPECT_EQ(differences(facts_of(m30), facts_of(m40)), "");
  EXPECT_EQ(differences(facts_of(m25), facts_of(m40)), "");
  const JointModel m12 = read(kModel12), m20 = read(kModel20);
  EXPECT_EQ(differences(facts_of(m20), facts_of(m40)), "");
  // 1.2 knows no following force, and puts elements together by material and shape in the order of their first one.
  EXPECT_EQ(differences(facts_of(m12), facts_of(m40), {"rigid loads", "thickness"}), "");
  EXPECT_EQ(m12.rigid_loads.back().kind, RigidLoad::Kind::Dead);
  EXPECT_EQ(m12.domains[1].shell_thickness, (std::vector<double>{0.5, 0.5, 0.5, 0.5}));
  EXPECT_EQ(m12.domains[2].element_ids, (std::vector<int>{3}));
  EXPECT_EQ(m25.version, "2.5");
  EXPECT_EQ(m40.version, "4.0");
  for (const JointModel* m : {&m12, &m20, &m25, &m30, &m40}) {
    EXPECT_TRUE(m->ignored.empty()) << m->ignored.front().what;
    EXPECT_TRUE(m->unsupported.empty()) << m->unsupported.front().what;
  }
}

// A text in memory is read as a file of the name that messages are to call it, which need not be there.
TEST_F(ReadFeb, ATextIsReadAsAFileOfItsName) {
  const std::string text = feb("4.0", kMaterials);
  const auto fault = [](const std::string& of) {
    try {
      read_feb_text(of, "folder/hip.feb");
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("read without a fault");
  };
  EXPECT_EQ(read_feb_text(text, "folder/hip.feb").materials.size(), 4u);
  EXPECT_EQ(read_feb_text(text, "folder/hip.feb").files, (std::vector<std::string>{"folder/hip.feb"}));
  EXPECT_EQ(fault(replaced(text, "<center_of_mass>0,0,0<", "<center_of_mass>0,0<")).rfind("folder/hip.feb:4: ", 0), 0u)
      << fault(replaced(text, "<center_of_mass>0,0,0<", "<center_of_mass>0,0<"));
  EXPECT_EQ(fault(text.substr(0, 300)).rfind("folder/hip.feb:", 0), 0u);
}

TEST_F(ReadFeb, SaysWhatTheFileSays) {
  const JointModel m = read(kModel40);
  ASSERT_EQ(m.files.size(), 1u);
  EXPECT_EQ(m.files[0], (folder_ / "model.feb").string());
  EXPECT_EQ(m.module, "biphasic");
  EXPECT_EQ(m.units, "mm-N-s");
  ASSERT_EQ(m.nodes.size(), 16u);
  EXPECT_EQ(m.node_ids[8], 11);
  EXPECT_EQ(m.nodes[14], Vector3d(1, 1, 2.5));
  ASSERT_EQ(m.domains.size(), 3u);
  EXPECT_EQ(m.domains[1].nodes, (std::vector<int>{8, 9, 10, 11, 12, 13, 14, 15}));
  EXPECT_EQ(m.domains[2].shell_thickness, (std::vector<double>{0.5, 0.5, 0.5, 0.5}));
  EXPECT_EQ(m.node_sets[0].nodes.size(), 16u);  // the named Nodes section is a set too, before the others
  EXPECT_EQ(m.node_sets[1].nodes, (std::vector<int>{15, 14, 12, 13}));  // in the order of the file
  EXPECT_EQ(m.node_sets[2].nodes, (std::vector<int>{0, 4, 7}));
  EXPECT_EQ(m.surfaces[1].begin, (std::vector<int>{0, 3, 6}));
  EXPECT_EQ(m.surfaces[1].nodes, (std::vector<int>{8, 10, 9, 8, 11, 10}));
  EXPECT_TRUE(m.materials[0].rigid);
  EXPECT_EQ(m.materials[0].center_of_mass, Vector3d(0, 0, 0));
  EXPECT_FALSE(m.materials[3].center_of_mass.has_value());
  EXPECT_EQ(m.materials[2].type, "biphasic/Holmes-Mow");
  EXPECT_EQ(m.materials[2].E, 5.0);
  EXPECT_EQ(m.materials[2].note, "drained solid");
  ASSERT_EQ(m.contacts.size(), 1u);
  EXPECT_EQ(m.surfaces[static_cast<std::size_t>(m.contacts[0].primary)].name, "bottom");
  EXPECT_EQ(m.contacts[0].ignored, (std::vector<std::string>{"fric_coeff = 0.2"}));
  ASSERT_EQ(m.steps.size(), 2u);
  EXPECT_DOUBLE_EQ(m.steps[0].duration, 1.0);  // the first step takes the control before it
  EXPECT_DOUBLE_EQ(m.steps[0].step_size, 0.25);
  EXPECT_EQ(m.steps[1].must_points, (std::vector<double>{1.5}));  // 0.5 lies in step one, which has none
  EXPECT_EQ(m.rigid_prescribed[0].step, 0);
  EXPECT_EQ(m.rigid_loads[1].step, 1);
  EXPECT_EQ(m.rigid_loads[1].kind, RigidLoad::Kind::Follower);
  EXPECT_DOUBLE_EQ(value(m, m.rigid_loads[0].value, 1.5), -75.0);
  EXPECT_EQ(where(m, m.materials[1].origin), m.files[0] + ":7: ");
}

// -- syntax ------------------------------------------------------------------------------------------

/// kModel40 with one piece exchanged.
std::string model_with(const std::string& from, const std::string& to) { return replaced(kModel40, from, to); }
/// kModel40 with sections before its end.
std::string model_and(const std::string& sections) {
  return replaced(kModel40, "</febio_spec>", sections + "</febio_spec>");
}

/// A 4.0 file with a few nodes and what stands in `mesh`.
std::string mesh_model(const std::string& mesh, const std::string& more = "") {
  std::string nodes;
  for (int i = 1; i <= 30; ++i) nodes += fmt::format("<node id=\"{}\">{},0,0</node>", i, i);
  return feb("4.0", "<Mesh><Nodes name=\"n\">" + nodes + "</Nodes>" + mesh + "</Mesh>" + more);
}

TEST_F(ReadFeb, EveryElementTypeHasItsShape) {
  const std::pair<const char*, ElementShape> types[] = {
      {"hex8", ElementShape::Hex8},       {"HEX8G8", ElementShape::Hex8},      {"hex20", ElementShape::Hex20},
      {"HEX20G8", ElementShape::Hex20},   {"hex27", ElementShape::Hex27},      {"penta6", ElementShape::Penta6},
      {"penta15", ElementShape::Penta15}, {"pyra5", ElementShape::Pyra5},      {"pyra13", ElementShape::Pyra13},
      {"tet4", ElementShape::Tet4},       {"ut4", ElementShape::Tet4},         {"TET4G4", ElementShape::Tet4},
      {"tet5", ElementShape::Tet5},       {"tet10", ElementShape::Tet10},      {"TET10G4", ElementShape::Tet10},
      {"TET10GL11", ElementShape::Tet10}, {"TET10G8_S3", ElementShape::Tet10}, {"tet15", ElementShape::Tet15},
      {"TET15G15", ElementShape::Tet15},  {"tet20", ElementShape::Tet20},      {"quad4", ElementShape::Quad4},
      {"q4eas", ElementShape::Quad4},     {"q4ans", ElementShape::Quad4},      {"q4s", ElementShape::Quad4},
      {"QUAD4G8", ElementShape::Quad4},   {"quad8", ElementShape::Quad8},      {"QUAD8G18", ElementShape::Quad8},
      {"quad9", ElementShape::Quad9},     {"tri3", ElementShape::Tri3},        {"tri3s", ElementShape::Tri3},
      {"TRI3G6", ElementShape::Tri3},     {"tri6", ElementShape::Tri6},        {"TRI6G14", ElementShape::Tri6},
      {"truss2", ElementShape::Line2},    {"line2", ElementShape::Line2},      {"line3", ElementShape::Line3}};
  for (const auto& type : types) {
    std::vector<int> nodes;
    for (int i = 1; i <= nodes_per_element(type.second); ++i) nodes.push_back(i);
    const JointModel m = read(mesh_model(fmt::format(
        "<Elements type=\"{}\" name=\"e\"><elem id=\"1\">{}</elem></Elements>", type.first, fmt::join(nodes, ","))));
    EXPECT_EQ(m.domains[0].shape, type.second) << type.first;
    EXPECT_EQ(m.domains[0].nodes.size(), nodes.size()) << type.first;
    EXPECT_EQ(m.domains[0].material, -1);
  }
}

TEST_F(ReadFeb, NodeSetsOfEveryKind) {
  const std::string mesh =
      R"(<Elements type="tri3" name="A"><elem id="5">3,2,4</elem><elem id="6">4,2,1</elem></Elements>
<Elements type="line2" name="B"><elem id="7">9,8</elem></Elements>
<NodeSet name="list">4, 7:9, 10:20:5,</NodeSet>
<NodeSet name="nested"><NodeSet node_set="list"/><n id="1"/><node_list>2,3</node_list></NodeSet>
<ElementSet name="two">6,7</ElementSet><PartList name="both">B,A</PartList>
<Edge name="rim"><line2 id="1">12,11</line2><line2 id="2">11,10</line2></Edge>
<Surface name="s"><tri3 id="1">6,5,7</tri3></Surface>)";
  const std::pair<const char*, std::vector<int>> sets[] = {{"list", {3, 6, 7, 8, 9, 14, 19}},
                                                           {"nested", {3, 6, 7, 8, 9, 14, 19, 0, 1, 2}},
                                                           {"@surface:s", {5, 4, 6}},
                                                           {"@edge:rim", {11, 10, 9}},
                                                           {"@elem_set:two", {3, 1, 0, 8, 7}},
                                                           {"@elem_set:A", {2, 1, 3, 0}},
                                                           {"@part_list:both", {8, 7, 2, 1, 3, 0}}};
  for (const auto& set : sets) {
    const JointModel m = read(mesh_model(
        mesh, fmt::format("<Boundary><bc type=\"zero displacement\" node_set=\"{}\"><y_dof>1</y_dof></bc></Boundary>",
                          set.first)));
    ASSERT_EQ(m.fixed_nodes.size(), 1u);
    EXPECT_EQ(m.fixed_nodes[0].nodes, set.second) << set.first;
    EXPECT_EQ(m.fixed_nodes[0].xyz, (std::array<bool, 3>{false, true, false}));
  }
  const JointModel named =
      read(mesh_model("", "<Boundary><bc type=\"zero displacement\" node_set=\"n\"><x_dof>1</x_dof></bc></Boundary>"));
  EXPECT_EQ(named.fixed_nodes[0].nodes.size(), 30u);
}

// FERigidFixedBCOld stays active from the start of the analysis: what is fixed in step 2 is fixed in step 1.
TEST_F(ReadFeb, WhatFilesBefore40FixInALaterStepHoldsFromTheFirstOn) {
  const auto fixed_in = [&](const std::string& in_one, const std::string& in_two) {
    const std::string one = "<Rigid><rigid_constraint type=\"prescribe\"",
                      two = "<Rigid><rigid_constraint type=\"force\"";
    return read(
        replaced(replaced(kModel30, one, "<Rigid>" + in_one + one.substr(7)), two, "<Rigid>" + in_two + two.substr(7)));
  };
  const auto fix = [](const char* dofs) {
    return fmt::format("<rigid_constraint type=\"fix\"><rb>4</rb><dofs>{}</dofs></rigid_constraint>", dofs);
  };
  const auto steps_of = [](const JointModel& m, int dof) {
    std::set<int> steps;
    for (const RigidFixed& f : m.rigid_fixed)
      if (m.materials[static_cast<std::size_t>(f.material)].name == "femur" && f.dofs[static_cast<std::size_t>(dof)])
        steps.insert(f.step);
    return steps;
  };
  const JointModel plain = fixed_in("", fix("Ry")), after_motion = fixed_in("", fix("Rz")),
                   after_fix = fixed_in(fix("Ry"), fix("Ry"));
  EXPECT_EQ(steps_of(plain, 1), (std::set<int>{0, 1}));
  EXPECT_NE(plain.assumed.back().what.find("y of \"femur\" is fixed in step 2, and from the first step on until step 2 "
                                           "ends"),
            std::string::npos)
      << plain.assumed.back().what;
  EXPECT_EQ(steps_of(after_motion, 2), (std::set<int>{1}));  // the motion of step 1 comes first
  EXPECT_EQ(steps_of(after_fix, 1), (std::set<int>{0, 1}));
  const JointModel new_words = read(replaced(
      kModel40, "</step></Step>",
      "<Rigid><rigid_bc type=\"rigid_fixed\"><rb>femur</rb><Ry_dof>1</Ry_dof></rigid_bc></Rigid></step></Step>"));
  EXPECT_EQ(steps_of(new_words, 1), (std::set<int>{1}));
}

// FEBioRigidSection.cpp: a moment has no type, and the type of a force is read as a number.
TEST_F(ReadFeb, LoadTypesOfVersion30) {
  const auto with = [&](const std::string& moment, const std::string& force) {
    return read(replaced(replaced(kModel30, "<load_type>0<", "<load_type>" + moment + "<"), "<load_type>1<",
                         "<load_type>" + force + "<"));
  };
  const JointModel numbers = with("2", "2"), words = with("2", "TARGET"), none = with("0", "0");
  ASSERT_EQ(numbers.rigid_loads.size(), 2u);
  EXPECT_EQ(numbers.rigid_loads[0].kind, RigidLoad::Kind::Dead);
  EXPECT_EQ(numbers.rigid_loads[1].kind, RigidLoad::Kind::Target);
  EXPECT_EQ(words.rigid_loads[0].kind, RigidLoad::Kind::Dead);
  EXPECT_EQ(words.rigid_loads[1].kind, RigidLoad::Kind::Dead);
  EXPECT_TRUE(words.unsupported.empty());
  EXPECT_EQ(numbers.assumed.size(), none.assumed.size() + 1);
  ASSERT_EQ(words.assumed.size(), none.assumed.size() + 2);
  EXPECT_EQ(words.assumed.back().what,
            "load_type TARGET of a force: LOAD, as in FEBio, which takes numbers alone in version 3.0");
}

TEST_F(ReadFeb, RotationVectorIsThreePrescribedRotations) {
  const JointModel m = read(model_and(
      R"(<Rigid><rigid_bc type="rigid_rotation_vector"><rb>femur</rb><vx lc="1">0.1</vx><vz>0.3</vz></rigid_bc>
<rigid_bc type="rigid_rotation"><rb>femur</rb><dof>Rv</dof><value>0.5</value><relative>1</relative></rigid_bc></Rigid>)"));
  ASSERT_EQ(m.rigid_prescribed.size(), 5u);
  EXPECT_EQ(m.rigid_prescribed[1].dof, 3);
  EXPECT_EQ(m.rigid_prescribed[1].value.controller, 0);
  EXPECT_EQ(m.rigid_prescribed[2].value.factor, 0.0);
  EXPECT_EQ(m.rigid_prescribed[2].value.controller, -1);
  EXPECT_EQ(m.rigid_prescribed[3].dof, 5);
  EXPECT_EQ(m.rigid_prescribed[4].dof, 4);
  EXPECT_TRUE(m.rigid_prescribed[4].relative);
  EXPECT_EQ(m.rigid_prescribed[4].step, 1);  // a section after a Step belongs to the last step
}

TEST_F(ReadFeb, StepsFollowTheirRules) {
  const std::string mats = kMaterials;
  const auto rigid = [](const char* name) {
    return fmt::format(
        "<Rigid><rigid_bc name=\"{}\" type=\"rigid_fixed\"><rb>femur</rb><Rx_dof>1</Rx_dof></rigid_bc></Rigid>", name);
  };
  const JointModel none = read(feb("4.0", mats));
  ASSERT_EQ(none.steps.size(), 1u);
  EXPECT_DOUBLE_EQ(none.steps[0].duration, 1.0);  // FEBio's defaults: 10 steps of 0.1
  EXPECT_DOUBLE_EQ(none.steps[0].step_size, 0.1);

  const JointModel m = read(
      feb("4.0", "<Control><time_steps>3</time_steps></Control>" + mats + rigid("before") + "<Step><step>" +
                     rigid("in one") + "<Control><step_size>0.5</step_size></Control></step><step>" + rigid("in two") +
                     "<Control><time_steps>-1</time_steps><final_time>7</final_time></Control></step></Step>" +
                     rigid("after")));
  ASSERT_EQ(m.steps.size(), 2u);
  EXPECT_DOUBLE_EQ(m.steps[0].duration, 1.5);  // 3 of the control before, 0.5 of its own
  EXPECT_DOUBLE_EQ(m.steps[1].duration, 7.0);
  ASSERT_EQ(m.rigid_fixed.size(), 4u);
  EXPECT_EQ(m.rigid_fixed[0].step, -1);
  EXPECT_EQ(m.rigid_fixed[1].step, 0);
  EXPECT_EQ(m.rigid_fixed[2].step, 1);
  EXPECT_EQ(m.rigid_fixed[3].step, 1);
}

TEST_F(ReadFeb, RigidBodiesOf25) {
  const JointModel m = read(replaced(kModel25, "</febio_spec>", R"(<Boundary><rigid_body mat="femur">
<prescribed bc="Ry" lc="1" type="relative">0.5</prescribed><force bc="y" lc="1" type="ramp">3</force>
<force bc="Rx" lc="1" type="follow">3</force><force bc="y">3</force><initial_velocity>1,0,0</initial_velocity>
</rigid_body></Boundary><Rigid/></febio_spec>)"));
  EXPECT_EQ(m.rigid_prescribed.back().dof, 4);  // Ry is a rotation in 2.5
  EXPECT_EQ(m.rigid_prescribed.back().material, 3);
  EXPECT_TRUE(m.rigid_prescribed.back().relative);
  EXPECT_EQ(m.rigid_loads.back().dof, 1);
  EXPECT_EQ(m.rigid_loads.back().value.controller, -1);
  EXPECT_EQ(m.rigid_loads[m.rigid_loads.size() - 2].kind, RigidLoad::Kind::Target);
  ASSERT_EQ(m.unsupported.size(), 2u);
  EXPECT_EQ(m.unsupported[0].what, "rigid moment with type \"follow\", which FEBio 4 leaves out");
  EXPECT_EQ(m.unsupported[1].what, "section <Rigid> in a version without one");
  ASSERT_EQ(m.ignored.size(), 1u);
  EXPECT_EQ(m.ignored[0].what, "initial velocity of a rigid body");
}

// A name that is a number is taken as an id first, as FEBio does.
TEST_F(ReadFeb, RigidBodyByIdBeforeName) {
  const std::string model =
      R"(<Material><material id="1" name="2" type="rigid body"/><material id="2" name="b" type="rigid body"/>
</Material><Rigid><rigid_bc type="rigid_fixed"><rb>2</rb><Rx_dof>1</Rx_dof></rigid_bc>
<rigid_bc type="rigid_fixed"><rb> b </rb><Rx_dof>1</Rx_dof></rigid_bc></Rigid>)";
  const JointModel m = read(feb("4.0", model));
  ASSERT_EQ(m.rigid_fixed.size(), 2u);
  EXPECT_EQ(m.rigid_fixed[0].material, 1);
  EXPECT_EQ(m.rigid_fixed[1].material, 1);
}

// -- materials ---------------------------------------------------------------------------------------

TEST_F(ReadFeb, SmallStrainConstantsOfTheMaterials) {
  struct Case {
    const char* version;
    const char* material;  ///< its type and what it contains
    double G, K;           ///< worked out by hand
    const char* note;
  };
  // E = 10, v = 0.25: G = 4, K = 20/3. f = 3/N = 0.3 with N = 10.
  const double f = 0.3;
  const double arruda =
      2 * (1 + 0.4 * f + 66.0 / 350 * f * f + 152.0 / 1750 * f * f * f + 5190.0 / 134750 * f * f * f * f);
  const Case cases[] = {
      {"4.0", R"(type="isotropic elastic"><E>10</E><v>0.25</v>)", 4, 20.0 / 3, ""},
      {"4.0", R"(type="EFD neo-Hookean"><E>10</E><v>0.25</v><beta>2,2,2</beta>)", 4, 20.0 / 3,
       "ground matrix without its fibres"},
      {"4.0", R"(type="Mooney-Rivlin"><c1>1</c1><c2>0.5</c2><k>100</k>)", 3, 100, ""},
      {"4.0", R"(type="trans iso Mooney-Rivlin"><c1>1</c1><c2>0.5</c2><c3>9</c3><k>100</k>)", 3, 100,
       "ground matrix without its fibres"},
      {"4.0", R"(type="Veronda-Westmann"><c1>2</c1><c2>3</c2><k>50</k>)", 6, 50, ""},
      {"4.0", R"(type="Ogden"><c1>2</c1><m1>2</m1><c3>4</c3><m3>2</m3><k>50</k>)", 3, 50, ""},
      {"4.0", R"(type="Gent"><G>3</G><Jm>10</Jm><k>30</k>)", 3, 30, ""},
      {"4.0", R"(type="Yeoh"><c1>2</c1><c2>8</c2><k>30</k>)", 4, 30, ""},
      {"4.0", R"(type="Arruda-Boyce"><mu>2</mu><N>10</N><k>30</k>)", arruda, 30, ""},
      {"4.0", R"(type="uncoupled Holmes-Mow"><mu>2</mu><beta>1</beta><k>30</k>)", 2, 30, ""},
      {"4.0", R"(type="Ogden unconstrained"><cp>5</cp><c1>6</c1><m1>2</m1>)", 3, 7, ""},
      {"4.0", R"(type="coupled Mooney-Rivlin"><c1>1</c1><c2>0.5</c2><k>10</k>)", 3, 14, ""},
      {"4.0", R"(type="coupled Veronda-Westmann"><c1>3</c1><c2>1</c2><k>10</k>)", 3, 18, ""},
      {"4.0", R"(type="coupled trans-iso Mooney-Rivlin"><c1>1</c1><c2>0.5</c2><c3>2</c3><k>10</k>)", 3, 14,
       "ground matrix without its fibres"},
      {"4.0", R"(type="Holzapfel-Gasser-Ogden"><c>3</c><k1>9</k1><k2>2</k2><kappa>0</kappa><gamma>30</gamma><k>50</k>)",
       3, 50, "ground matrix without its fibres"},
      {"4.0", R"(type="HGO unconstrained"><c>3</c><k1>9</k1><k2>2</k2><kappa>0.1</kappa><gamma>30</gamma><k>5</k>)", 3,
       7, "ground matrix without its fibres"},
      {"4.0",
       R"(type="solid mixture"><solid type="neo-Hookean"><E>10</E><v>0.25</v></solid><solid type="neo-Hookean"><E>20</E><v>0.25</v></solid>)",
       12, 20, ""},
      {"4.0",
       R"(type="solid mixture"><solid type="neo-Hookean"><E>10</E><v>0.25</v></solid><solid type="fiber-exp-pow"><ksi>5</ksi></solid>)",
       4, 20.0 / 3, "ground matrix without its fibres"},
      {"2.5", R"(type="uncoupled solid mixture"><k>10</k><solid type="Yeoh"><c1>2</c1><k>30</k></solid>)", 4, 40, ""},
      {"4.0", R"(type="uncoupled solid mixture"><k>10</k><solid type="Yeoh"><c1>2</c1><k>30</k></solid>)", 4, 10, ""},
      {"2.5",
       R"(type="biphasic"><solid type="uncoupled solid mixture"><k>10</k><solid type="Yeoh"><c1>2</c1><k>30</k></solid></solid>)",
       4, 10, "drained solid"},
      {"4.0", R"(type="uncoupled prestrain elastic"><k>10</k><elastic type="Yeoh"><c1>2</c1><k>30</k></elastic>)", 4,
       10, "prestrain left out"},
      {"4.0", R"(type="viscoelastic"><g0>0.5</g0><g1>2</g1><elastic type="neo-Hookean"><E>10</E><v>0.25</v></elastic>)",
       2, 10.0 / 3, "long-term (g0 = 0.5)"},
      {"4.0", R"(type="uncoupled viscoelastic"><g0>0.5</g0><k>30</k><elastic type="Yeoh"><c1>2</c1></elastic>)", 2, 30,
       "long-term (g0 = 0.5)"},
      // FEBio's viscoelastic one adds the k nested in it, whatever the version
      {"4.0", R"(type="uncoupled viscoelastic"><k>30</k><elastic type="Yeoh"><c1>2</c1><k>500</k></elastic>)", 4, 530,
       "long-term (g0 = 1)"},
      {"2.5", R"(type="uncoupled viscoelastic"><k>30</k><elastic type="Yeoh"><c1>2</c1><k>500</k></elastic>)", 4, 530,
       "long-term (g0 = 1)"},
      {"4.0", R"(type="uncoupled viscoelastic"><elastic type="Yeoh"><c1>2</c1><k>500</k></elastic>)", 4, 500,
       "long-term (g0 = 1)"},
      {"4.0", R"(type="prestrain elastic"><elastic type="neo-Hookean"><E>10</E><v>0.25</v></elastic>)", 4, 20.0 / 3,
       "prestrain left out"},
      {"4.0", R"(type="multiphasic"><solid type="neo-Hookean"><E>10</E><v>0.25</v></solid>)", 4, 20.0 / 3,
       "drained solid"},
      {"4.0",
       R"(type="triphasic"><fixed_charge_density>0</fixed_charge_density><solid type="neo-Hookean"><E>10</E><v>0.25</v></solid>)",
       4, 20.0 / 3, "drained solid"},
  };
  for (const Case& c : cases) {
    const JointModel m = read(
        feb(c.version, fmt::format("<Material><material id=\"1\" name=\"a\" {}</material></Material>", c.material)));
    EXPECT_NEAR(m.materials[0].E, 9 * c.K * c.G / (3 * c.K + c.G), 1e-12 * c.K) << c.material;
    EXPECT_NEAR(m.materials[0].nu, (3 * c.K - 2 * c.G) / (2 * (3 * c.K + c.G)), 1e-13) << c.material;
    EXPECT_EQ(m.materials[0].note, c.note) << c.material;
  }
}

TEST_F(ReadFeb, MaterialsWithoutConstantsSayWhy) {
  const std::pair<const char*, const char*> cases[] = {
      {R"(type="multiphasic"><fixed_charge_density>-200</fixed_charge_density><solid type="neo-Hookean"><E>1</E><v>0.1</v></solid>)",
       "its fixed charges make it swell (fixed_charge_density), at rest too, which has no single E and nu"},
      {R"(type="triphasic"><fixed_charge_density type="math">-X</fixed_charge_density><solid type="neo-Hookean"><E>1</E><v>0.1</v></solid>)",
       "its fixed charges make it swell (fixed_charge_density), at rest too, which has no single E and nu"},
      {R"(type="neo-Hookean"><E type="math">1+X</E><v>0</v>)", "E is a \"math\", not one number"},
      {R"(type="neo-Hookean"><E>1+X</E><v>0</v>)", "E = \"1+X\" is not one number"},
      {R"(type="neo-Hookean"><E lc="1">1</E><v>0</v>)", "E follows a load controller"},
      {R"(type="Mooney-Rivlin"><c1>1</c1>)", "no stiffness: G = 2, K = 0, need both > 0"},
      {R"(type="plugin jelly"><E>1</E>)", "no small-strain E and nu are known for type \"plugin jelly\""},
      {R"(type="orthotropic elastic"><E1>1</E1><E2>1</E2><G12>1</G12><G23>1</G23><G31>1</G31><v12>0</v12><v23>0</v23>)",
       "orthotropic, no single E and nu; missing: E3, v31"},
      {R"(type="orthotropic elastic"><E1>1</E1><E2>1</E2><E3>1</E3><G12>1</G12><G23>1</G23><G31>1</G31><v12>2</v12><v23>0</v23><v31>0</v31>)",
       "orthotropic, no single E and nu; no elastic body has its E1 to v31: need E and G > 0, and v12 < sqrt(E1/E2) "
       "and "
       "so on"},
      {R"(type="Fung orthotropic"><E1>1</E1><E2>1</E2><E3>1</E3><G12>1</G12><G23>1</G23><G31>1</G31><v12>0</v12><v23>0</v23><v31>0</v31><c>1</c>)",
       "orthotropic, no single E and nu; no stiffness: K = 0, need K > 0"},
      {R"(type="biphasic"><phi0>0.2</phi0>)", "\"biphasic\" without a nested solid"},
      {R"(type="solid mixture"><solid type="jelly"/>)", "no small-strain E and nu are known for type \"jelly\""},
  };
  for (const auto& c : cases) {
    const JointModel m =
        read(feb("4.0", fmt::format("<Material><material id=\"1\" name=\"a\" {}</material></Material>", c.first)));
    EXPECT_TRUE(std::isnan(m.materials[0].E)) << c.first;
    EXPECT_TRUE(std::isnan(m.materials[0].nu)) << c.first;
    EXPECT_EQ(m.materials[0].note, c.second);
  }
}

/// The matrices of materials with axes, on paper: Fung's has no K of its own, its twin adds k; what is nested is told
/// in the axes of what is around it; what relaxes, relaxes all of it.
TEST_F(ReadFeb, StiffnessOfMaterialsWithAxes) {
  const std::string constants =
      "<E1>140</E1><E2>20</E2><E3>30</E3><G12>50</G12><G23>11</G23><G31>60</G31><v12>0.4</v12><v23>0.3</v23><v31>0.1</"
      "v31>"
      "<c>1</c>";
  const auto material = [&](const std::string& text) {
    return read(feb("4.0", "<Material><material id=\"1\" name=\"a\" " + text + "</material></Material>")).materials[0];
  };
  const auto sum = [](const Material& m) {
    Matrix6d D = Matrix6d::Zero();
    for (const StiffnessInAxes& of : m.stiffness) D += of.D;
    return D;
  };
  const Matrix6d own = *orthotropic_stiffness({140, 20, 30}, {50, 11, 60}, {0.4, 0.3, 0.1});
  const std::string along =
      "<mat_axis type=\"cylindrical\"><center>1,2,3</center><axis>0,0,2</axis><vector>0,3,0</vector></mat_axis>";
  const Material fung = material("type=\"Fung orthotropic\">" + constants + "<k>90</k>" + along);
  EXPECT_LT((sum(fung) - deviatoric_stiffness(own) - lame_stiffness(0, 90)).norm(), 1e-10);
  ASSERT_EQ(fung.stiffness[0].axes.size(), 1u);
  EXPECT_EQ(fung.stiffness[0].axes[0].by, Axes::By::Cylindrical);
  EXPECT_EQ(fung.stiffness[0].axes[0].center, Vector3d(1, 2, 3));
  EXPECT_EQ(fung.stiffness[0].axes[0].axis, Vector3d::UnitZ());
  EXPECT_EQ(fung.stiffness[0].axes[0].a, Vector3d::UnitY());
  EXPECT_TRUE(std::isnan(fung.E));
  EXPECT_LT(
      (sum(material("type=\"Fung-ortho-compressible\">" + constants + "<k>5</k>")) - own - lame_stiffness(0, 5)).norm(),
      1e-10);
  const Material wet = material(
      "type=\"biphasic\">" + along +
      "<solid type=\"viscoelastic\"><g0>0.5</g0><elastic type=\"solid mixture\">"
      "<solid type=\"neo-Hookean\"><E>10</E><v>0.25</v></solid><solid type=\"orthotropic elastic\">" +
      constants +
      "<mat_axis type=\"angles\"><theta>90</theta><phi>90</phi></mat_axis></solid><solid type=\"fiber-NH\"><mu>3</mu>"
      "<fiber type=\"angles\"><theta>0</theta><phi>0</phi></fiber></solid></elastic></solid>");
  EXPECT_TRUE(wet.fluid);
  EXPECT_LT((sum(wet) - 0.5 * own - 0.5 * isotropic_stiffness(10, 0.25)).norm(), 1e-10);
  ASSERT_EQ(wet.stiffness[0].axes.size(), 2u);
  EXPECT_EQ(wet.stiffness[0].axes[0].by, Axes::By::Cylindrical);
  EXPECT_LT((wet.stiffness[0].axes[1].a - Vector3d::UnitY()).norm(), 1e-15);
  EXPECT_LT((wet.stiffness[0].axes[1].d + Vector3d::UnitX()).norm(), 1e-15);
  ASSERT_EQ(wet.fibres.size(), 1u);
  EXPECT_LT((wet.fibres[0].direction.vector - Vector3d::UnitZ()).norm(), 1e-15);
  EXPECT_EQ(wet.fibres[0].axes.size(), 1u);
  EXPECT_EQ(wet.fibres[0].path, "solid.elastic.solid[2]");
  EXPECT_DOUBLE_EQ(fibre_modulus(wet.fibres[0], 0), 0.5 * 2 * 3);
}

/// Moduli at no strain, on paper, of what FEBio has for fibres.
TEST_F(ReadFeb, LawsOfFibres) {
  struct Case {
    const char* solid;
    double modulus;  ///< NaN: it is not known
  };
  const Case cases[] = {
      {R"(type="fiber-NH"><mu>3</mu>)", 6},
      {R"(type="fiber-exp-pow"><ksi>5</ksi><alpha>9</alpha><beta>2</beta>)", 20},
      {R"(type="fiber-exp-pow-uncoupled"><ksi>5</ksi>)", 20},
      {R"(type="fiber-exp-pow"><ksi>5</ksi><lam0>1.02</lam0>)", 0},
      {R"(type="fiber-exp-pow"><ksi>5</ksi><mu>1</mu>)", kNaN},
      {R"(type="fiber-exp-linear"><c3>0.5</c3><c4>20</c4><c5>9</c5><lambda>1.05</lambda>)", 10},
      {R"(type="uncoupled fiber-exp-linear"><c3>0.5</c3><c4>20</c4><c5>9</c5><lambda>1.05</lambda>)", 10},
      {R"(type="fiber-pow"><ksi>5</ksi><beta>2</beta>)", 40},
      {R"(type="fiber-pow-linear"><E>9</E><beta>2</beta><lam0>1.05</lam0>)", 9 / std::pow(1.05, 3)},
      {R"(type="fiber-exp-pow-linear"><E>9</E><alpha>1</alpha><lam0>1.05</lam0>)", 0},
      {R"(type="fiber-natural-NH"><ksi>7</ksi>)", 7},
      {R"(type="fiber-Kiousis-uncoupled"><d1>3</d1><d2>1</d2><n>2</n>)", 12},
      {R"(type="fiber-entropy-chain"><N>3</N><ksi>1</ksi>)", kNaN},
      {R"(type="continuous fiber distribution"><fibers type="fiber-NH"><mu>3</mu></fibers><distribution type="spherical"/><scheme type="fibers-3d-gkt"/>)",
       6},
      {R"(type="continuous fiber distribution"><fibers type="fiber-NH"><mu>3</mu></fibers><distribution type="jelly"/><scheme type="fibers-3d-gkt"/>)",
       kNaN},
  };
  for (const Case& c : cases) {
    const JointModel m = read(feb(
        "4.0",
        fmt::format(
            R"(<Material><material id="1" name="a" type="solid mixture"><solid type="neo-Hookean"><E>1</E><v>0</v></solid><solid {}</solid></material></Material>)",
            c.solid)));
    ASSERT_EQ(m.materials[0].fibres.size(), 1u) << c.solid;
    const Fibres& fibres = m.materials[0].fibres[0];
    EXPECT_EQ(fibres.law == Fibres::Law::Unknown, std::isnan(c.modulus)) << c.solid;
    if (!std::isnan(c.modulus)) {
      EXPECT_NEAR(fibre_modulus(fibres, 0), c.modulus, 1e-12) << c.solid;
    }
  }
  // two families in the plane of the first two axes; what is spread of them pulls as much in all directions
  const auto families = [&](const char* type, double kappa) {
    return read(
               feb("4.0",
                   fmt::format(
                       R"(<Material><material id="1" name="a" type="{}"><c>1</c><k1>9</k1><k2>2</k2><kappa>{}</kappa><gamma>30</gamma><k>50</k></material></Material>)",
                       type, kappa)))
        .materials[0]
        .fibres.at(0);
  };
  const Fibres flat = families("HGO unconstrained", 0.1);
  const Vector3d a(std::cos(std::acos(-1.0) / 6), 0.5, 0), b(a.x(), -0.5, 0);
  Matrix6d expected = Matrix6d::Zero();
  for (const Vector3d& n : {a, b}) {
    Vector6d h;  // kappa 1 + (1 - 3 kappa) n n
    h << 0.7 * n.x() * n.x() + 0.1, 0.7 * n.y() * n.y() + 0.1, 0.1, 0.7 * n.x() * n.y(), 0, 0;
    expected += 4 * 9 * h * h.transpose();
  }
  ASSERT_TRUE(flat.spread);
  EXPECT_LT((fibre_modulus(flat, 0) * *flat.spread - expected).norm(), 1e-10);
  const Fibres dev = families("Holzapfel-Gasser-Ogden", 0.1);
  EXPECT_LT((fibre_modulus(dev, 0) * *dev.spread - deviatoric_stiffness(expected)).norm(), 1e-10);
  EXPECT_EQ(families("HGO unconstrained", 1.0 / 3).law, Fibres::Law::Unknown);
}

/// Directions of each element, by the name of a map and by the place in a mixture.
TEST_F(ReadFeb, DirectionsOfElementsByName) {
  const JointModel m = read(model_and(
      R"(<Material><material id="9" name="m" type="solid mixture"><solid type="neo-Hookean"><E>1</E><v>0</v></solid><solid type="fiber-NH"><mu>3</mu><fiber type="map">ring</fiber></solid><solid type="fiber-NH"><mu>3</mu><fiber type="user"/></solid></material></Material>
<MeshDomains><SolidDomain name="L" mat="m"/></MeshDomains>
<MeshData><ElementData name="ring" elem_set="L" data_type="vec3"><e lid="1">0,3,4</e></ElementData>
<ElementData name="other" elem_set="L" data_type="vec3"><e lid="1">1,0,0</e></ElementData>
<ElementData type="solid[2].fiber" elem_set="L"><e lid="1">0,0,5</e></ElementData></MeshData>)"));
  const Domain& layer =
      *std::find_if(m.domains.begin(), m.domains.end(), [](const Domain& d) { return d.name == "L"; });
  ASSERT_EQ(layer.fibre.size(), 2u);
  EXPECT_LT((layer.fibre.at("solid[1]")[0] - Vector3d(0, 0.6, 0.8)).norm(), 1e-15);
  EXPECT_LT((layer.fibre.at("solid[2]")[0] - Vector3d::UnitZ()).norm(), 1e-15);
}

// What has no place in E and nu is listed, with its line.
TEST_F(ReadFeb, PartsOfMaterialsThatAreLeftOutAreIgnoredAloud) {
  const std::pair<const char*, std::vector<const char*>> cases[] = {
      {R"(type="trans iso Mooney-Rivlin"><c1>1</c1><c2>0</c2><c3>9</c3><k>100</k>)",
       {"the fibres of \"trans iso Mooney-Rivlin\""}},
      {R"(type="EFD neo-Hookean"><E>10</E><v>0.25</v><beta>2,2,2</beta>)", {"the fibres of \"EFD neo-Hookean\""}},
      {R"(type="solid mixture"><solid type="neo-Hookean"><E>10</E><v>0.25</v></solid><solid type="fiber-exp-pow"><ksi>5</ksi></solid>)",
       {"the fibres \"fiber-exp-pow\" of its \"solid mixture\""}},
      {R"(type="solid mixture"><solid type="neo-Hookean"><E>10</E><v>0.25</v></solid><solid type="spherical fiber distribution"><ksi>5</ksi></solid>)",
       {"the fibres \"spherical fiber distribution\" of its"}},
      {R"(type="viscoelastic"><g1>0.9</g1><t1>10</t1><elastic type="neo-Hookean"><E>10</E><v>0.25</v></elastic>)",
       {"the relaxation of \"viscoelastic\""}},
      {R"(type="prestrain elastic"><elastic type="trans iso Mooney-Rivlin"><c1>1</c1><k>100</k></elastic>)",
       {"the fibres of \"trans iso Mooney-Rivlin\"", "the prestrain of \"prestrain elastic\""}},
      {R"(type="solid mixture"><solid type="neo-Hookean"><E>10</E><v>0.25</v></solid><solid type="neo-Hookean"><E>20</E><v>0.25</v></solid>)",
       {}},
      {R"(type="Mooney-Rivlin"><c1>1</c1><c2>0.5</c2><k>100</k>)", {}},
      {R"(type="multiphasic"><solid type="neo-Hookean"><E>10</E><v>0.25</v></solid><solid_bound sbm="1"><rho0>1</rho0></solid_bound>)",
       {"<solid_bound> of \"multiphasic\""}},
  };
  for (const auto& c : cases) {
    const JointModel m =
        read(feb("4.0", fmt::format("<Material><material id=\"1\" name=\"a\" {}</material></Material>", c.first)));
    EXPECT_GT(m.materials[0].E, 0) << c.first;
    ASSERT_EQ(m.ignored.size(), c.second.size()) << c.first;
    for (std::size_t i = 0; i < c.second.size(); ++i) {
      EXPECT_EQ(m.ignored[i].what.find(fmt::format("material \"a\": {}", c.second[i])), 0u) << m.ignored[i].what;
      EXPECT_GT(m.ignored[i].origin.line, 0);
    }
  }
}

// -- contacts ----------------------------------------------------------------------------------------

TEST_F(ReadFeb, ContactsSlideOrTie) {
  for (const char* type :
       {"sliding-elastic", "sliding-tension-compression", "sliding-facet-on-facet", "facet-to-facet sliding",
        "sliding-node-on-facet", "sliding_with_gaps", "sliding2", "sliding-biphasic", "sliding-biphasic-mixed",
        "sliding-biphasic-solute", "sliding-multiphasic"}) {
    EXPECT_EQ(read(model_with("sliding-elastic", type)).contacts.at(0).kind, Contact::Kind::Sliding) << type;
  }
  for (const char* type :
       {"tied-node-on-facet", "tied-facet-on-facet", "tied-elastic", "sticky", "tied-biphasic", "tied-multiphasic"}) {
    const JointModel m = read(
        replaced(model_with("sliding-elastic", type), "<penalty>20</penalty>", "<max_distance>0.3</max_distance>"));
    EXPECT_EQ(m.contacts.at(0).kind, Contact::Kind::Tied) << type;
    const bool by_distance = std::string(type) == "tied-node-on-facet" || std::string(type) == "tied-facet-on-facet" ||
                             std::string(type) == "sticky";
    EXPECT_EQ(m.contacts.at(0).max_distance, by_distance ? 0.3 : 1.0) << type;
  }
}

// FEBio 4.11, FENormalProjection::Project2: of three types the search radius is the gap that is too wide to be tied.
TEST_F(ReadFeb, TiesReachAsFarAsFebios) {
  const auto contact = [&](const char* type, const std::string& parameters) {
    return read(replaced(model_with("sliding-elastic", type), "<search_radius>1</search_radius>", parameters))
        .contacts.at(0);
  };
  for (const char* type : {"tied-elastic", "tied-biphasic", "tied-multiphasic"}) {
    EXPECT_EQ(contact(type, "").max_distance, 1.0) << type;
    const Contact given = contact(type, "<search_radius>0.25</search_radius>");
    EXPECT_EQ(given.max_distance, 0.25) << type;
    EXPECT_EQ(given.ignored, (std::vector<std::string>{"fric_coeff = 0.2"})) << type;
  }
  for (const char* type : {"tied-node-on-facet", "tied-facet-on-facet"})
    EXPECT_EQ(contact(type, "").max_distance, 0.0) << type;
}

TEST_F(ReadFeb, SearchRadiusIsListedAwayFromTheDefaultOfItsType) {
  const JointModel elastic = read(model_with("<search_radius>1<", "<search_radius>0.5<"));
  EXPECT_EQ(elastic.contacts[0].ignored, (std::vector<std::string>{"fric_coeff = 0.2", "search_radius = 0.5"}));
  const JointModel facet = read(model_with("sliding-elastic", "sliding-facet-on-facet"));
  EXPECT_EQ(facet.contacts[0].ignored, (std::vector<std::string>{"fric_coeff = 0.2", "search_radius = 1"}));
}

// -- what is left out --------------------------------------------------------------------------------

// At right angles to an axis it holds its nodes in that component.
TEST_F(ReadFeb, SymmetryPlanesHoldTheirNodes) {
  const std::string plain = model_with("</Mesh>", "</Mesh>");
  const std::size_t before = read(plain).fixed_nodes.size();
  const JointModel model = read(model_with(
      "</febio_spec>", R"(<Constraints><constraint type="symmetry plane" surface="top"/></Constraints></febio_spec>)"));
  ASSERT_EQ(model.fixed_nodes.size(), before + 1);
  const FixedNodes& held = model.fixed_nodes.back();
  EXPECT_EQ(held.xyz, (std::array<bool, 3>{false, false, true}));
  EXPECT_EQ(held.nodes.size(), 4u);
}

TEST_F(ReadFeb, WhatChangesTheMechanicsIsListedAsUnsupported) {
  const std::pair<const char*, const char*> cases[] = {
      {R"(<Rigid><rigid_load type="rigid_moment"><rb>femur</rb><dof>Ru</dof><value>1</value><load_type>FOLLOW</load_type></rigid_load></Rigid>)",
       "rigid moment with load_type FOLLOW"},
      {R"(<Rigid><rigid_bc type="rigid_euler_angles"><rb>femur</rb><Ex lc="1">3</Ex><Ey>4</Ey></rigid_bc></Rigid>)",
       "rigid_euler_angles of which several turn and one follows a load controller"},
      {R"(<Rigid><rigid_connector type="rigid ratchet"/></Rigid>)", "rigid connector \"rigid ratchet\""},
      {R"(<Discrete><discrete_material id="3" type="Hill"/><discrete dmat="3" discrete_set="ligament"/></Discrete>)",
       "discrete material \"Hill\""},
      {R"(<Contact><contact type="periodic boundary" surface_pair="pair"/></Contact>)",
       "contact \"periodic boundary\""},
      {R"(<Contact><contact type="rigid_wall" surface="top"/></Contact>)", "contact \"rigid_wall\""},
      {R"(<Constraints><constraint type="volume" surface="top"/></Constraints>)", "constraint \"volume\""},
      {R"(<Constraints><constraint type="symmetry plane" surface="nowhere"/></Constraints>)",
       "constraint \"symmetry plane\""},
      {R"(<Boundary><bc type="prescribed displacement" node_set="side"><dof>z</dof><value lc="1">0.1*X</value></bc></Boundary>)",
       "prescribed displacement of nodes that differs from node to node"},
      {R"(<Boundary><bc type="linear constraint"/></Boundary>)", "bc \"linear constraint\""},
      {R"(<Loads><nodal_load type="nodal_load" node_set="side"><dof>x</dof><scale>2*X</scale></nodal_load></Loads>)",
       "nodal load whose scale is \"2*X\""},
      {R"(<Loads><nodal_load type="nodal_force" node_set="side"><value>1,0,0</value><relative>1</relative></nodal_load></Loads>)",
       "nodal load with relative = 1"},
      {R"(<Loads><surface_load type="pressure" surface="top"><pressure lc="1">2</pressure></surface_load></Loads>)",
       "surface_load \"pressure\""},
      {R"(<Loads><surface_load type="force" surface="top"><scale lc="1">-10</scale><force>0,0,1</force></surface_load></Loads>)",
       "surface_load \"force\""},
      {R"(<Loads><body_load type="body force"><force>0,0,-9</force></body_load></Loads>)", "body_load \"body force\""},
      {R"(<LoadData><load_controller id="3" type="PID"/></LoadData>
<Rigid><rigid_load type="rigid_force"><rb>femur</rb><dof>Rx</dof><value lc="3">1</value></rigid_load></Rigid>)",
       "load controller 3 with type \"PID\""},
      {R"(<LoadData><load_controller id="3" type="math"><math>t+u</math></load_controller></LoadData>
<Rigid><rigid_load type="rigid_force"><rb>femur</rb><dof>Rx</dof><value lc="3">1</value></rigid_load></Rigid>)",
       "load controller 3 with expression \"t+u\": unknown name \"u\""},
      {R"(<LoadData><load_controller id="3" type="math"><var>fem.x</var><math>t</math></load_controller></LoadData>
<Loads><nodal_load type="nodal_load" node_set="side"><dof>x</dof><scale lc="3">2</scale></nodal_load></Loads>)",
       "load controller 3 with expression \"t\": a <var>, a number of FEBio's model"},
      {R"(<LoadData><load_controller id="3"><interpolate>CUBIC SPLINE</interpolate></load_controller></LoadData>
<Rigid><rigid_load type="rigid_force"><rb>femur</rb><dof>Rx</dof><value lc="3">1</value></rigid_load></Rigid>)",
       "load controller 3 with 0 points, interpolation \"cubic spline\" needs 2"},
  };
  for (const auto& c : cases) {
    const JointModel m = read(model_and(c.first));
    ASSERT_EQ(m.unsupported.size(), 1u) << c.first;
    EXPECT_EQ(m.unsupported[0].what, c.second);
    EXPECT_GT(m.unsupported[0].origin.line, 40) << c.first;
    EXPECT_TRUE(m.ignored.empty()) << m.ignored[0].what;
  }
}

TEST_F(ReadFeb, WhatIsHarmlessIsListedOnceAsIgnored) {
  const std::pair<const char*, const char*> cases[] = {
      {R"(<Rigid><rigid_connector type="rigid damper"/></Rigid>)", "rigid damper: statics has no velocity"},
      {R"(<Rigid><rigid_ic type="initial_rigid_velocity"><rb>femur</rb><value>1,0,0</value></rigid_ic></Rigid>)",
       "initial velocity of a rigid body"},
      {R"(<Control><analysis>dynamic</analysis></Control>)",
       "analysis DYNAMIC: DEA is quasi-static, inertia is left out"},
      {R"(<Control><analysis>1</analysis></Control>)",  // the file's module is biphasic
       "analysis TRANSIENT: DEA uses the drained solid, fluid flow is left out"},
      {R"(<Loads><surface_load type="pressure"><pressure lc="1">0</pressure></surface_load></Loads>)",
       "surface_load \"pressure\" of zero"},
      {R"(<Boundary><bc type="zero rotation" node_set="side"/></Boundary>)", "bc \"zero rotation\""},
      {R"(<Initial><ic type="init_dof"/></Initial>)", "initial conditions"},
      {R"(<Novelty><x/></Novelty>)", "section <Novelty>"},
  };
  for (const auto& c : cases) {
    const JointModel m = read(model_and(std::string(c.first) + c.first));
    ASSERT_EQ(m.ignored.size(), 1u) << c.first;
    EXPECT_EQ(m.ignored[0].what, c.second);
    EXPECT_EQ(m.ignored[0].count, 2);
    EXPECT_TRUE(m.unsupported.empty()) << c.first;
  }
}

// FEBio's parameters that dea needs not are passed over in silence; those of nobody are listed once per word, and those
// that may be meant for one of dea's are refused, in every version.
TEST_F(ReadFeb, ParametersThatNobodyKnowsAreListedOnce) {
  const std::pair<const char*, const char*> cases[] = {
      {R"(<Material><material id="9" name="m" type="Mooney-Rivlin"><c1>1</c1><c2>0</c2><k>9</k><pressure_model>1</pressure_model><glue>1</glue><glue>2</glue></material></Material>)",
       "<glue> in material \"Mooney-Rivlin\", none of FEBio's words"},
      {R"(<Contact><contact type="sliding-elastic" surface_pair="pair"><laugon>0</laugon><tolerance>0.1</tolerance><glue>1</glue></contact><contact type="sliding-elastic" surface_pair="pair"><glue>1</glue></contact></Contact>)",
       "<glue> in contact \"sliding-elastic\", none of FEBio's words"},
      {R"(<Rigid><rigid_connector type="rigid lock"><body_a>1</body_a><body_b>4</body_b><first_axis>1,0,0</first_axis><second_axis>0,1,0</second_axis><laugon>0</laugon><gaptol>0</gaptol><glue>1</glue><glue>1</glue></rigid_connector></Rigid>)",
       "<glue> in rigid_connector \"rigid lock\", none of FEBio's words"},
  };
  for (const auto& c : cases) {
    const JointModel m = read(model_and(c.first));
    ASSERT_EQ(m.ignored.size(), 1u) << c.first;
    EXPECT_EQ(m.ignored[0].what, c.second);
    EXPECT_EQ(m.ignored[0].count, 2);
  }
  // FEBio reads a word as 0
  EXPECT_EQ(fault_of(replaced(kModel40, "<x_dof>1<", "<x_dof>False<")), "read without a fault");
  // fibres and axes of materials and of elements
  const JointModel along = read(model_and(
      R"(<Material><material id="9" name="m" type="trans iso Mooney-Rivlin"><c1>1</c1><c2>0</c2><c3>0.5</c3><c4>40</c4><c5>100</c5><lam_max>1.05</lam_max><k>9</k><fiber type="local">1,5</fiber><mat_axis type="vector"><a>0,0,2</a><d>1,0,0</d></mat_axis></material>
<material id="10" name="o" type="orthotropic elastic"><E1>140</E1><E2>20</E2><E3>20</E3><G12>50</G12><G23>8</G23><G31>50</G31><v12>0.3</v12><v23>0.3</v23><v31>0.04</v31></material></Material>
<MeshData><ElementData type="fiber" elem_set="L"><e lid="1">0,3,4</e></ElementData>
<ElementData type="mat_axis" elem_set="L"><e lid="1"><a>0,1,0</a><d>1,0,0</d></e></ElementData></MeshData>)"));
  const auto material = [&](const char* name) {
    return *std::find_if(along.materials.begin(), along.materials.end(),
                         [&](const Material& m) { return m.name == name; });
  };
  const Material fibrous = material("m");
  ASSERT_EQ(fibrous.fibres.size(), 1u);
  EXPECT_EQ(fibrous.fibres[0].c, (std::array<double, 4>{0.5, 40, 100, 1.05}));
  EXPECT_TRUE(fibrous.fibres[0].deviatoric);
  EXPECT_EQ(fibrous.fibres[0].direction.by, Direction::By::Nodes);
  EXPECT_EQ(fibrous.fibres[0].direction.nodes, (std::array<int, 2>{0, 4}));
  ASSERT_EQ(fibrous.fibres[0].axes.size(), 1u);
  EXPECT_EQ(fibrous.fibres[0].axes[0].by, Axes::By::Vectors);
  EXPECT_EQ(fibrous.fibres[0].axes[0].a, Vector3d(0, 0, 2));
  ASSERT_EQ(material("o").stiffness.size(), 2u);  // that in axes, and what is isotropic of it
  EXPECT_NEAR(1 / material("o").stiffness[0].D.inverse()(0, 0), 140, 1e-9);
  EXPECT_EQ(material("o").stiffness[1].D.norm(), 0);
  const Domain& layer =
      *std::find_if(along.domains.begin(), along.domains.end(), [](const Domain& d) { return d.name == "L"; });
  ASSERT_EQ(layer.fibre.size(), 1u);
  EXPECT_LT((layer.fibre.at("")[0] - Vector3d(0, 0.6, 0.8)).norm(), 1e-15);
  ASSERT_EQ(layer.axes.size(), 1u);
  EXPECT_EQ(layer.axes[0].col(0), Vector3d(0, 1, 0));
  // a modulus per element: the one of the material would be wrong without a word
  EXPECT_NE(fault_of(replaced(kModel25, "<MeshData>",
                              "<MeshData><ElementData var=\"fem.material[1].E\" elem_set=\"L\"><elem "
                              "lid=\"1\">9</elem></ElementData>"))
                .find("ElementData gives \"fem.material[1].E\" element by element, expected one value"),
            std::string::npos);
  EXPECT_NE(fault_of(replaced(kModel25, "<prescribed bc=\"z\" lc=", "<prescribed bc=\"z\" LC="))
                .find("<prescribed> with LC = \"1\": did you mean lc?"),
            std::string::npos);
  for (const std::string* model : {&kModel12, &kModel20, &kModel25, &kModel30, &kModel40}) {
    EXPECT_NE(fault_of(replaced(*model, "<v>0.1</v>", "<nu>0.1</nu>")).find("did you mean <v>?"), std::string::npos);
    EXPECT_NE(fault_of(replaced(*model, "<E>4</E>", "<e>4</e>")).find("did you mean <E>?"), std::string::npos);
  }
}

TEST_F(ReadFeb, DofsOfFixedNodesMayBeJoinedButFluidVelocitiesAreNoDisplacement) {
  const std::pair<const char*, std::array<bool, 3>> cases[] = {{"x,y,z", {true, true, true}},
                                                               {"xz", {true, false, true}},
                                                               {"xyzuvw", {true, true, true}},
                                                               {" y , w ", {false, true, false}},
                                                               {"x,wz,wy", {true, false, false}}};
  for (const auto& c : cases) {
    EXPECT_EQ(read(replaced(kModel25, "bc=\"x,z\"", fmt::format("bc=\"{}\"", c.first))).fixed_nodes.at(0).xyz, c.second)
        << c.first;
  }
  EXPECT_TRUE(read(replaced(kModel25, "bc=\"x,z\"", "bc=\"wx,wy,p\"")).fixed_nodes.empty());
}

TEST_F(ReadFeb, PrescribedDisplacementOfNodesInAllVersions) {
  struct Case {
    const std::string& model;
    const char* condition;
  };
  const Case cases[] = {
      {kModel40,
       R"(<bc name="up" type="prescribed displacement" node_set="@surface:bottom"><dof>y</dof><value lc="1">0.2</value><relative>1</relative></bc>)"},
      {kModel30,
       R"(<bc name="up" type="prescribe" node_set="@surface:bottom"><dof>y</dof><scale lc="1">0.2</scale><relative>1</relative></bc>)"},
      {kModel25,
       R"(<prescribe name="up" bc="y" node_set="@surface:bottom"><scale lc="1">0.2</scale><relative>1</relative></prescribe>)"},
      {kModel20,
       R"(<prescribe name="up" bc="y" lc="1" scale="0.2" type="relative"><node id="5">0.2</node><node id="6"/><node id="7"/><node id="8"/></prescribe>)"},
      {kModel12,
       R"(<prescribe name="up" type="relative"><node id="5" bc="y" lc="1">0.2</node><node id="6" bc="y" lc="1">0.2</node><node id="7" bc="y" lc="1">0.2</node><node id="8" bc="y" lc="1">0.2</node></prescribe>)"},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.condition);
    const JointModel m =
        read(replaced(c.model, "</febio_spec>", fmt::format("<Boundary>{}</Boundary></febio_spec>", c.condition)));
    ASSERT_EQ(m.prescribed_nodes.size(), 1u);
    const PrescribedNodes& p = m.prescribed_nodes[0];
    EXPECT_EQ(p.component, 1);
    EXPECT_EQ(p.value.factor, 0.2);
    EXPECT_EQ(p.value.controller, 0);
    EXPECT_TRUE(p.relative);
    EXPECT_EQ(p.step, 1);  // sections behind a step belong to it
    EXPECT_EQ(p.nodes, (std::vector<int>{4, 5, 6, 7}));
    EXPECT_TRUE(m.unsupported.empty());
  }
  // nodes of a rigid body, by its elements or by a rigid node set
  for (const char* set : {"side", "held"}) {
    const JointModel m = read(model_and(fmt::format(
        R"(<Boundary><bc type="prescribed displacement" node_set="{}"><dof>y</dof><value>0.2</value></bc></Boundary>)",
        set)));
    EXPECT_TRUE(m.prescribed_nodes.empty());
    ASSERT_EQ(m.unsupported.size(), 1u);
    EXPECT_NE(m.unsupported[0].what.find(" of rigid body \""), std::string::npos) << m.unsupported[0].what;
  }
}

TEST_F(ReadFeb, ZeroPrescribedDisplacementHoldsTheNodes) {
  const JointModel m = read(model_and(
      R"(<Boundary><bc type="prescribed displacement" node_set="held"><dof>y</dof><value lc="1">0</value></bc></Boundary>)"));
  ASSERT_EQ(m.fixed_nodes.size(), 2u);
  EXPECT_EQ(m.fixed_nodes[1].xyz, (std::array<bool, 3>{false, true, false}));
  EXPECT_TRUE(m.unsupported.empty());
}

TEST_F(ReadFeb, AControllerNobodyUsesMayBeOfAnyKind) {
  EXPECT_TRUE(read(model_and(R"(<LoadData><load_controller id="3" type="PID"/></LoadData>)")).unsupported.empty());
}

// -- several files -----------------------------------------------------------------------------------

TEST_F(ReadFeb, SectionsMayLieInOtherFiles) {
  const Facts whole = facts_of(read(kModel40));
  write("sub/materials.feb", feb("4.0", kMaterials));
  const JointModel from = read(replaced(kModel40, kMaterials, "<Material from=\"sub/materials.feb\"/>"));
  EXPECT_EQ(differences(whole, facts_of(from)), "");
  ASSERT_EQ(from.files.size(), 2u);
  EXPECT_EQ(where(from, from.materials[1].origin), (folder_ / "sub/materials.feb").string() + ":5: ");
  EXPECT_EQ(where(from, from.contacts[0].origin).rfind((folder_ / "model.feb").string(), 0), 0u);

  write("materials.feb", feb("3.0", kMaterials));
  const JointModel include = read(replaced(kModel40, kMaterials, "<Include>materials.feb</Include>"));
  EXPECT_EQ(differences(whole, facts_of(include)), "");
}

TEST_F(ReadFeb, BadIncludesAreRefused) {
  write("a.feb", feb("4.0", "<Include>b.feb</Include>"));
  write("b.feb", feb("4.0", "\n<Include>a.feb</Include>"));
  EXPECT_EQ(fault((folder_ / "a.feb").string()), "b.feb:4: \"a.feb\" includes itself: remove one include");
  EXPECT_EQ(fault_of(feb("4.0", "<Mesh from=\"none.feb\"/>")),
            "model.feb:3: no such file: \"none.feb\": check the path");
  write("old.feb", feb("1.1", ""));
  EXPECT_EQ(fault_of(feb("4.0", "<Include>old.feb</Include>")),
            "old.feb:2: version \"1.1\", expected 1.2, 2.0, 2.5, 3.0 or 4.0: open it in FEBio Studio and save as 4.0");
  write("empty.feb", feb("4.0", ""));
  EXPECT_EQ(fault_of(feb("4.0", "<Mesh from=\"empty.feb\"/>")),
            "empty.feb:2: no <Mesh> here, which \"model.feb\" takes from this file: add it, or take out its from");
  std::string often;
  for (int i = 0; i < 1001; ++i) often += "<Include>empty.feb</Include>";
  EXPECT_EQ(fault_of(feb("4.0", often)),
            "model.feb:3: more than 1000 includes: does a file include others without end?");
}

// -- refusals ----------------------------------------------------------------------------------------

TEST_F(ReadFeb, FilesThatAreNoModelAreRefused) {
  EXPECT_EQ(fault((folder_ / "none.feb").string()), "none.feb: no such file: check the path");
  EXPECT_EQ(fault(folder_.string()), folder_.string() + ": this is a folder, expected a .feb file");
  EXPECT_EQ(fault(write("p.fs2", "\x01\x02")),
            "p.fs2: this is a FEBio Studio project; export the FEBio file: File > Export FE model (.feb)");
  EXPECT_EQ(fault(write("p.fsm", "<?xml?>")),
            "p.fsm: this is a FEBio Studio project; export the FEBio file: File > Export FE model (.feb)");
  EXPECT_EQ(fault_of(""), "model.feb: the file is empty, expected a FEBio model: save it again");
  EXPECT_EQ(fault_of("solid cube\nfacet"),
            "model.feb:1: the file starts with \"solid cube\\nf\", expected \"<?xml\": this is no FEBio model (.feb)");
  EXPECT_EQ(fault_of("<?xml version=\"1.0\"?>\n<html/>"),
            "model.feb:2: the root is \"html\", expected <febio_spec>: this is no FEBio model");
  EXPECT_EQ(fault_of("\xFF\xFE<"), "model.feb:1: this is text in UTF-16, expected UTF-8: save it with that encoding");
  EXPECT_EQ(fault_of(std::string("BEF\0\1", 5)),
            "model.feb: this is a plot file, expected a FEBio model (.feb): dea plot and dea compare show it");
  EXPECT_EQ(fault("/dev/null"), "/dev/null: not a file, expected a .feb file");
  EXPECT_EQ(fault_of("<?xml version=\"1.0\"?>\n"),
            "model.feb:1: no element at all, expected <febio_spec>: this is no FEBio model");
  std::string deep;
  for (int i = 0; i < 100'000; ++i) deep += "<a>";
  EXPECT_EQ(fault_of(feb("4.0", deep)), "model.feb:3: XML nested too deeply: this is no FEBio model");
  EXPECT_EQ(
      fault_of(feb("5.0", "")),
      "model.feb:2: version \"5.0\", expected 1.2, 2.0, 2.5, 3.0 or 4.0: open it in FEBio Studio and save as 4.0");
  EXPECT_NE(fault_of(kModel40.substr(0, kModel40.size() / 2))
                .find("the file ends without </febio_spec>: it is cut off; save or copy it again"),
            std::string::npos);
  EXPECT_EQ(
      fault_of(feb("4.0", "<a>\n</b>\n")),
      "model.feb:3: broken XML (XML_ERROR_MISMATCHED_ELEMENT): the file is damaged here; repair or save it again");
}

TEST_F(ReadFeb, FaultsAreRefusedWithTheirLine) {
  struct Case {
    const char* from;  ///< a piece of kModel40
    const char* to;
    const char* fault;
  };
  const Case cases[] = {
      {"<v>0.4</v>", "<v>0.5</v>", "7: material \"lower\": v = 0.5, need -1 < v < 0.5"},
      {"<v>0.1</v>", "<v>-1</v>", "8: material \"upper\": v = -1, need -1 < v < 0.5"},
      {"<E>10</E>", "<E>0</E>", "7: material \"lower\": E = 0, need E > 0"},
      {"<E>10</E>", "", "7: material \"lower\": E is missing, need E > 0"},
      {"<density>2<", "<density>-2<", "6: material \"plate\": density = -2, need density >= 0"},
      {"<center_of_mass>0,0,0<", "<center_of_mass>0,0<",
       "6: center_of_mass = \"0,0\", expected three numbers x,y,z of at most 1e30"},
      {"id=\"2\" name=\"lower\"", "id=\"1\" name=\"lower\"",
       "7: material id 1 exists twice: \"plate\" and \"lower\"; renumber one"},
      {"name=\"lower\"", "name=\"plate\"", "7: material \"plate\" exists twice: rename one"},
      {"<node id=\"2\">", "<node id=\"1\">", "12: node 1 exists twice: renumber one"},
      {"<node id=\"2\">", "<node id=\"x\">", "12: <node> with id = \"x\", expected a positive whole number"},
      {"<node id=\"2\">1,0,0<", "<node id=\"2\">1,nan,0<",
       "12: node 2 is \"1,nan,0\", expected numbers of at most 1e30"},
      {"<node id=\"2\">1,0,0<", "<node id=\"2\">1,0,-inf<",
       "12: node 2 is \"1,0,-inf\", expected numbers of at most 1e30"},
      {"<node id=\"2\">1,0,0<", "<node id=\"2\">1,1e31,0<",
       "12: node 2 is \"1,1e31,0\", expected numbers of at most 1e30"},
      {"<node id=\"2\">1,0,0<", "<node id=\"2\">1,1e999,0<",
       "12: node 2 is \"1,1e999,0\", expected numbers of at most 1e30"},
      {"<node id=\"2\">1,0,0<", "<node id=\"2\">1 0 0<", "12: node 2 is \"1 0 0\", expected three numbers x,y,z"},
      {"<node id=\"2\">1,0,0<", "<node id=\"2\">1,0<", "12: node 2 is \"1,0\", expected three numbers x,y,z"},
      {"<node id=\"2\">1,0,0<", "<node id=\"2\">1,0,0,0<", "12: node 2 is \"1,0,0,0\", expected three numbers x,y,z"},
      {"5,6,7,8</elem>", "5,6,7</elem>", "17: hex8 element 1 has 7 nodes, expected 8"},
      {"5,6,7,8</elem>", "5,6,7,8,11</elem>", "17: hex8 element 1 has 9 nodes, expected 8"},
      {"5,6,7,8</elem>", "5,6,7,9</elem>",
       "17: hex8 element 1 uses node 9, which does not exist: mend the number, or add the node"},
      {"5,6,7,8</elem>", "5,6,7,q</elem>", "17: <elem> lists \"q\", expected whole numbers and commas"},
      {"<elem id=\"2\">", "<elem id=\"1\">", "18: element 1 exists twice: renumber one"},
      {"type=\"hex8\" name=\"L\"", "type=\"brick\" name=\"L\"",
       "17: element type \"brick\" is unknown, expected one like hex8, tet4, tet10, penta6, quad4, tri3"},
      {"name=\"U\"><elem", "name=\"L\"><elem", "18: Elements \"L\" exists twice: rename one"},
      {"<quad4 id=\"1\">5,6,7,8<", "<quad4 id=\"1\">5,6,6,8<",
       "20: quad4 facet 1 of surface \"bottom\" has a node twice (\"5,6,6,8\"): repair the mesh"},
      {"<quad4 id=\"1\">5,6,7,8<", "<quad4 id=\"1\">5,6,7,99<",
       "20: quad4 facet 1 of surface \"bottom\" uses node 99, which does not exist: mend the number, or add the node"},
      {"<quad4 id=\"1\">5,6,7,8</quad4>", "<hex8 id=\"1\">1</hex8>",
       "20: <hex8> in surface \"bottom\", expected tri3, tri6, quad4, quad8 or another facet"},
      {"<Surface name=\"top\">", "<Surface name=\"bottom\">", "21: surface \"bottom\" exists twice: rename one"},
      {"18, 17, 15,\n16", "18, 99",
       "22: <NodeSet> uses node 99, which does not exist: mend the number, or add the node"},
      {"1,5:8:3", "8:5", "23: range 8:5:1, expected first:last:step going up"},
      {"1,5:8:3", "1,5:2000000000",
       "23: <NodeSet> uses node 9, which does not exist: mend the number, or add the node"},
      {"<primary>bottom<", "<primary>bottem<",
       "24: surface pair \"pair\" names \"bottem\", expected the name of a Surface above it (did you mean "
       "\"bottom\"?); the model has \"bottom\", \"top\""},
      {"<primary>bottom</primary>", "",
       "24: surface pair \"pair\" without <primary>: add it, with the name of a surface"},
      {"<delem>1,18<", "<delem>1<", "25: spring 1 of discrete set \"ligament\" has 1 nodes, expected 2"},
      {"mat=\"lower\"", "mat=\"2\"",
       "26: <SolidDomain> with mat = \"2\", expected the name of a material; the model has \"femur\", \"lower\", "
       "\"plate\", \"upper\""},
      {"SolidDomain name=\"L\"", "SolidDomain name=\"X\"",
       "26: SolidDomain \"X\" names no Elements section: expected the name of one in Mesh; the model has \"L\", \"P\", "
       "\"U\""},
      {"type=\"zero displacement\" node_set=\"side\"", "type=\"zero displacement\" node_set=\"sode\"",
       "28: \"sode\" names no node set (did you mean \"side\"?); the model has \"all\", \"held\", \"side\""},
      {"<x_dof>1<", "<x_dof>true<", "28: x_dof = \"true\", expected 0 or 1 (a word is 0 for FEBio, whatever it says)"},
      {"<rb>femur</rb><clamp", "<rb>tibia</rb><clamp",
       "29: \"tibia\" names no material, expected the id or name of a rigid body; rigid bodies: \"plate\", \"femur\""},
      {"<rb>femur</rb><clamp", "<rb>2</rb><clamp",
       "29: material \"lower\" is \"neo-Hookean\", expected a rigid body; rigid bodies: \"plate\", \"femur\""},
      {"<rb>plate</rb>", "", "30: <rigid_bc> without <rb>: add it, with the name of a rigid material"},
      {"<body_a>plate<", "<body_a>9<",
       "31: \"9\" names no material, expected the id or name of a rigid body; rigid bodies: \"plate\", \"femur\""},
      {"surface_pair=\"pair\"", "surface_pair=\"pear\"",
       "33: surface_pair = \"pear\", expected the name of a SurfacePair; the model has \"pair\""},
      {"discrete_set=\"ligament\"", "discrete_set=\"ligamint\"",
       "37: discrete_set = \"ligamint\", expected the name of a DiscreteSet (did you mean \"ligament\"?); the model "
       "has "
       "\"ligament\""},
      {"dmat=\"2\"", "dmat=\"3\"", "37: dmat = \"3\", expected the number of one of the 2 discrete materials above it"},
      {"<dof>z</dof>", "<dof>w</dof>", "39: <rigid_bc> with dof \"w\", expected one of x, y, z"},
      {"<value lc=\"1\">-0.1<", "<value lc=\"7\">-0.1<",
       "39: lc = 7, but there is no load controller 7: add it to LoadData, or use one of those there (ids \"1\", "
       "\"2\")"},
      {"<value lc=\"1\">-0.1<", "<value lc=\"a\">-0.1<",
       "39: value has lc = \"a\", expected the id of a load controller"},
      {"<value lc=\"1\">-0.1<", "<value lc=\"1\">fast<", "39: value = \"fast\", expected a number of at most 1e30"},
      {"<dtmax lc=\"2\">", "<dtmax lc=\"5\">",
       "40: lc = 5, but there is no load controller 5: add it to LoadData, or use one of those there (ids \"1\", "
       "\"2\")"},
      {"<step_size>0.25<", "<step_size>0<", "4: step_size = 0, need step_size > 0"},
      {"<time_steps>4<", "<time_steps>-4<", "4: time_steps = -4, need time_steps >= 0, or -1 with a final_time"},
      {"<time_steps>10<", "<time_steps>-1<", "40: time_steps = -1 without a final_time > 0: give one of them"},
      {"<load_type>FOLLOW<", "<load_type>PULL<", "42: load_type = \"PULL\", expected LOAD, FOLLOW or TARGET"},
      {"<point>1,1<", "<point>1<",
       "44: point \"1\" of load controller 1, expected two numbers time,value of at most 1e30"},
      {"<load_controller id=\"2\"", "<load_controller id=\"1\"", "45: load controller 1 exists twice: renumber one"},
      {"<load_controller id=\"2\" type=\"loadcurve\"", "<load_controller id=\"2\" type=\"math\"",
       "45: load controller of type math without <math>: add it, an expression in t"},
      {"type=\"zero displacement\" node_set=\"side\"", "type=\"zero displacement\"",
       "28: <bc> without attribute node_set: add it, with the name of a node set"},
      {"<value lc=\"1\">-50</value>", "", "41: <rigid_load> without <value>: add it"},
      {"<load_type>FOLLOW</load_type></rigid_load>",
       "</rigid_load><rigid_load type=\"rigid_cable\"><force>1</force></rigid_load>",
       "42: rigid_cable without <rigid_cable_point>: add the points it runs through"},
      {"type=\"linear spring\"><E>3</E>", "type=\"nonlinear spring\">",
       "35: nonlinear spring without <force>: add it, of type point or math"},
      {"<quad4 id=\"1\">5,6,7,8</quad4></Surface>", "</Surface>",
       "33: contact \"joint\" uses surface \"bottom\", which has no facets: define it again, or take the contact out"},
      {"<step id=\"1\" name=\"one\">", "<step id=\"1\" name=\"one\"><step/>",
       "38: a step inside a step, expected steps one after the other: move it out"},
      {"</febio_spec>", "<Include> </Include></febio_spec>",
       "46: <Include> without a file name: give one, or take it out"},
  };
  for (const Case& c : cases)
    EXPECT_EQ(fault_of(model_with(c.from, c.to)), std::string("model.feb:") + c.fault) << c.to;
}

TEST_F(ReadFeb, NodeSetsDefinedTwiceAreRefusedOnlyWhereTheyDiffer) {
  const std::string use = "<Boundary><bc type=\"zero displacement\" node_set=\"a\"><x_dof>1</x_dof></bc></Boundary>";
  EXPECT_EQ(
      read(mesh_model("<NodeSet name=\"a\">1,2</NodeSet><NodeSet name=\"a\">1,2</NodeSet>", use)).fixed_nodes.size(),
      1u);
  EXPECT_EQ(fault_of(mesh_model("<NodeSet name=\"a\">1,2</NodeSet><NodeSet name=\"a\">1,3</NodeSet>", use)),
            "model.feb:3: node set \"a\" exists twice with different nodes: rename one");
}

TEST_F(ReadFeb, NestedSetsCannotFillTheMemory) {
  std::string mesh = "<NodeSet name=\"s0\">1:30</NodeSet>";
  for (int i = 1; i < 40; ++i)
    mesh += fmt::format("<NodeSet name=\"s{0}\"><NodeSet node_set=\"s{1}\"/><NodeSet node_set=\"s{1}\"/></NodeSet>", i,
                        i - 1);
  EXPECT_EQ(fault_of(mesh_model(mesh)),
            "model.feb:3: the sets list more than 100000000 nodes or elements: is one listed again and again?");
}

// One part of 100 000 nodes, 51 times.
TEST_F(ReadFeb, InstancesCannotFillTheMemory) {
  std::string mesh = "<Part name=\"P\"><Nodes>";
  for (int i = 1; i <= 100'000; ++i) mesh += fmt::format("<node id=\"{}\">0,0,0</node>", i);
  mesh += "</Nodes></Part>\n";
  for (int i = 0; i < 51; ++i) mesh += fmt::format("<Instance part=\"P\" name=\"i{}\"/>\n", i);
  EXPECT_EQ(fault_of(feb("2.5", "<Geometry>" + mesh + "</Geometry>")),
            "model.feb:3: the instances of parts have more than 5000000 nodes and elements: is one copied again and "
            "again?");
}

const std::string kPart =
    R"(<Part name="P"><Nodes name="n"><node id="1">1,0,0</node><node id="2">0,2,0</node><node id="3">0,0,3</node></Nodes>
<Elements type="tri3" name="E" mat="1"><elem id="1">1,2,3</elem></Elements><NodeSet name="s"><node id="3"/></NodeSet>
<Surface name="top"><tri3 id="1">1,2,3</tri3></Surface></Part>
)";
const std::string kInstances =
    R"(<Instance part="P" name="Q"><translate>10,0,0</translate><rotate type="vector">0,0,90</rotate><scale>2,1,1</scale>
<Elements name="E" mat="b"/></Instance>
<Instance part="P"><rotate type="Euler">90,0,90</rotate></Instance>
<Surface name="both"><Surface surface="Q.top"/><Surface surface="P.top"/></Surface>
)";

// (1,0,0) scaled to (2,0,0), turned to (0,2,0), moved to (10,2,0). By Euler angles: about x, then z: (0,2,0) -> (0,0,2)
// -> (0,0,2), (0,0,3) -> (0,-3,0) -> (3,0,0).
TEST_F(ReadFeb, InstancesOfPartsAreMovedCopies) {
  const std::string materials =
      R"(<Material><material id="1" name="a" type="rigid body"/><material id="2" name="b" type="rigid body"/></Material>)";
  const std::string use = R"(<Boundary><fix bc="x" node_set="Q.s"/></Boundary>)";
  const JointModel m = read(feb("2.5", materials + "<Geometry>" + kPart + kInstances + "</Geometry>" + use));
  write("sub/part.feb", feb("2.5", "<Geometry>" + kPart + "</Geometry>"));
  const JointModel from = read(
      feb("2.5", materials + "<Geometry><Part name=\"P\" from=\"sub/part.feb\"/>" + kInstances + "</Geometry>" + use));
  for (const JointModel* model : {&m, &from}) {
    ASSERT_EQ(model->nodes.size(), 6u);
    EXPECT_EQ(model->node_ids, (std::vector<int>{1, 2, 3, 4, 5, 6}));
    const Vector3d expected[] = {{10, 2, 0}, {8, 0, 0}, {10, 0, 3}, {0, 1, 0}, {0, 0, 2}, {3, 0, 0}};
    for (std::size_t i = 0; i < 6; ++i) EXPECT_LT((model->nodes[i] - expected[i]).norm(), 1e-14) << i;
    EXPECT_EQ(model->domains[0].name, "Q.E");
    EXPECT_EQ(model->domains[0].material, 1);
    EXPECT_EQ(model->domains[1].name, "P.E");
    EXPECT_EQ(model->domains[1].material, 0);
    EXPECT_EQ(model->domains[1].nodes, (std::vector<int>{3, 4, 5}));
    EXPECT_EQ(model->domains[1].element_ids, (std::vector<int>{2}));
    EXPECT_EQ(model->surfaces.back().name, "both");
    EXPECT_EQ(model->surfaces.back().nodes, (std::vector<int>{0, 1, 2, 3, 4, 5}));
    EXPECT_EQ(model->fixed_nodes.at(0).nodes, (std::vector<int>{2}));
  }
  EXPECT_EQ(fault_of(feb("2.5", "<Geometry>\n<Instance part=\"p\"/></Geometry>")),
            "model.feb:4: part = \"p\", expected the name of a Part above it");
}

TEST_F(ReadFeb, FaultsOfPartsHaveTheirLine) {
  const auto of_geometry = [&](const std::string& geometry) {
    return fault_of(feb("2.5", kMaterials + "<Geometry>\n" + geometry + "</Geometry>"));
  };
  const auto of_instance = [&](const std::string& inside) {
    return of_geometry(kPart + "<Instance part=\"P\">" + inside + "</Instance>\n");
  };
  EXPECT_EQ(
      of_instance("<rotate>0,0,1,0</rotate>"),
      "model.feb:13: rotate = \"0,0,1,0\": FEBio turns by no quaternion whose last number is 0; give a half turn with "
      "type vector, in degrees");
  EXPECT_EQ(of_instance("<rotate>0,0,0.3,0.4</rotate>"),
            "model.feb:13: rotate: the quaternion has length 0.5, expected x,y,z,w of length 1 (FEBio would scale the "
            "part by the square of it)");
  EXPECT_EQ(of_instance("<rotate type=\"matrix\">1</rotate>"),
            "model.feb:13: rotate with type \"matrix\", expected quaternion, vector or Euler");
  EXPECT_EQ(of_instance("<rotate>0,0,1</rotate>"), "model.feb:13: rotate = \"0,0,1\", expected 4 numbers");
  EXPECT_EQ(of_instance("<scale>1,0,1</scale>"), "model.feb:13: scale = \"1,0,1\", need three factors > 0");
  EXPECT_EQ(of_instance("<shear>1</shear>"),
            "model.feb:13: <shear> in Instance, expected translate, rotate, scale or Elements");
  EXPECT_EQ(of_geometry(kPart + kPart), "model.feb:13: part \"P\" exists twice: rename one");
  EXPECT_EQ(of_geometry("<Part name=\"P\" type=\"copy\"/>"),
            "model.feb:10: Part with type \"copy\", expected template or instance");
  EXPECT_EQ(
      of_geometry(replaced(kPart, " mat=\"1\"", "") + "<Instance part=\"P\"/>"),
      "model.feb:11: Elements \"E\" of an instance without a material: add <Elements name= mat=/> to its <Instance>");
}

// Two cubes on each other: of their 12 sides the two that meet are inside.
TEST_F(ReadFeb, ASurfacePairOfPartsIsTheirOuterBoundary) {
  const std::string mesh =
      R"(<Elements type="hex8" name="A"><elem id="1">1,2,3,4,5,6,7,8</elem></Elements>
<Elements type="hex8" name="B"><elem id="2">5,6,7,8,9,10,11,12</elem></Elements><PartList name="both">A,B</PartList>
<Surface name="s"><tri3 id="1">20,21,22</tri3></Surface>
<SurfacePair name="p"><primary>@part_list:both</primary><secondary>s</secondary></SurfacePair>)";
  const JointModel m =
      read(mesh_model(mesh, "<Contact><contact type=\"sliding-elastic\" surface_pair=\"p\"/></Contact>"));
  const Surface& surface = m.surfaces.at(static_cast<std::size_t>(m.contacts.at(0).primary));
  EXPECT_EQ(surface.size(), 10);
  for (int i = 0; i < surface.size(); ++i) {
    std::set<int> nodes(surface.nodes.begin() + 4 * i, surface.nodes.begin() + 4 * (i + 1));
    EXPECT_NE(nodes, (std::set<int>{4, 5, 6, 7}));
  }
  EXPECT_EQ(fault_of(mesh_model(replaced(mesh, ">A,B<", ">A,C<"))),
            "model.feb:4: part list \"both\" names \"C\", expected the name of an Elements section");
  EXPECT_EQ(fault_of(mesh_model(replaced(mesh, "@part_list:both", "@part_list:none"))),
            "model.feb:6: \"@part_list:none\" names no part list, expected the name of a PartList above it");
}

// -- joints, forces, springs ---------------------------------------------------------------------------

using Motion = RigidJoint::Motion;

std::string connector(const std::string& type, const std::string& inside) {
  return fmt::format(
      "<Rigid><rigid_connector type=\"{}\"><body_a>plate</body_a><body_b>femur</body_b>{}</rigid_connector></Rigid>",
      type, inside);
}

TEST_F(ReadFeb, JointsHaveTheirAxesFirst) {
  const auto joint = [&](const std::string& type, const std::string& inside) {
    const JointModel m = read(model_and(connector(type, inside)));
    EXPECT_TRUE(m.unsupported.empty()) << type << ": " << m.unsupported.front().what;
    return m.rigid_joints.at(0);
  };
  const auto motions = [](const RigidJoint& j) {
    std::string text;
    for (const Motion motion : j.motion) text += "HFP"[static_cast<int>(motion)];
    return text;
  };
  const RigidJoint hinge = joint("rigid revolute joint",
                                 "<joint_origin>1,2,3</joint_origin><rotation_axis>0,2,0</rotation_axis>"
                                 "<transverse_axis>0,1,1</transverse_axis><moment lc=\"1\">5</moment>");
  EXPECT_EQ(motions(hinge), "HHHFHH");
  EXPECT_EQ(hinge.joint_origin, Vector3d(1, 2, 3));
  EXPECT_LT((hinge.axes - (Eigen::Matrix3d() << 0, 0, 1, 1, 0, 0, 0, 1, 0).finished()).norm(), 1e-15);
  EXPECT_EQ(hinge.value[3].factor, 5.0);
  EXPECT_EQ(hinge.value[3].controller, 0);
  EXPECT_EQ(hinge.material_a, 0);
  EXPECT_EQ(hinge.material_b, 3);
  EXPECT_EQ(hinge.step, 1);

  const RigidJoint turned =
      joint("rigid revolute joint", "<prescribed_rotation>1</prescribed_rotation><rotation lc=\"2\">0.5</rotation>");
  EXPECT_EQ(motions(turned), "HHHPHH");
  EXPECT_EQ(turned.axes.col(0), Vector3d(0, 0, 1));  // FEBio's defaults
  EXPECT_EQ(turned.axes.col(1), Vector3d(1, 0, 0));
  EXPECT_EQ(turned.value[3].factor, 0.5);
  EXPECT_EQ(turned.value[3].controller, 1);

  const RigidJoint slider =
      joint("rigid prismatic joint", "<translation_axis>0,0,1</translation_axis><force>2</force>");
  EXPECT_EQ(motions(slider), "FHHHHH");
  EXPECT_EQ(slider.axes.col(0), Vector3d(0, 0, 1));
  EXPECT_EQ(slider.value[0].factor, 2.0);
  EXPECT_EQ(motions(joint("rigid cylindrical joint",
                          "<joint_axis>0,0,1</joint_axis><prescribed_translation>1</prescribed_translation>")),
            "PHHFHH");
  const RigidJoint plane =
      joint("rigid planar joint",
            "<rotation_axis>0,0,1</rotation_axis><translation_axis_1>1,0,0</translation_axis_1>"
            "<prescribed_translation_2>1</prescribed_translation_2><translation_2>3</translation_2>");
  EXPECT_EQ(motions(plane), "HFPFHH");
  EXPECT_EQ(plane.axes.col(2), Vector3d(0, 1, 0));
  EXPECT_EQ(plane.value[2].factor, 3.0);
  EXPECT_EQ(motions(joint("rigid lock", "<first_axis>1,0,0</first_axis><second_axis>0,1,0</second_axis>")), "HHHHHH");
  EXPECT_EQ(motions(joint("rigid joint", "<joint>1,0,0</joint><penalty>9</penalty>")), "HHHFFF");
  EXPECT_EQ(motions(joint("rigid spherical joint", "<laugon>AUGLAG</laugon>")), "HHHFFF");
  EXPECT_EQ(motions(joint("generic rigid joint",
                          "<prescribe_x>0</prescribe_x><prescribe_z>2</prescribe_z><prescribe_Ry>0</prescribe_Ry>"
                          "<prescribe_Rz>0</prescribe_Rz>")),
            "HFPFHH");
}

// Moments of a spherical joint keep their global directions: loads on both bodies, + on A.
TEST_F(ReadFeb, MomentsOfASphericalJointAreLoads) {
  const JointModel m = read(model_and(connector("rigid spherical joint", "<moment_y lc=\"1\">4</moment_y>")));
  ASSERT_EQ(m.rigid_loads.size(), 4u);
  EXPECT_EQ(m.rigid_loads[2].material, 0);
  EXPECT_EQ(m.rigid_loads[2].dof, 4);
  EXPECT_EQ(m.rigid_loads[2].value.factor, 4.0);
  EXPECT_EQ(m.rigid_loads[3].material, 3);
  EXPECT_EQ(m.rigid_loads[3].value.factor, -4.0);
  EXPECT_EQ(m.rigid_loads[3].value.controller, 0);
}

TEST_F(ReadFeb, JointsThatCannotBeTakenAreUnsupportedOrRefused) {
  const std::tuple<const char*, const char*, const char*> cases[] = {
      {"rigid revolute joint", "<torsion_stiffness>2</torsion_stiffness>",
       "rigid revolute joint with torsion_stiffness"},
      {"rigid revolute joint", "<laugon>LAGMULT</laugon><moment>2</moment>",
       "rigid revolute joint with laugon LAGMULT, where FEBio leaves out its moment"},
      {"rigid spherical joint", "<prescribed_rotation>1</prescribed_rotation><rotation_x>1</rotation_x>",
       "rigid spherical joint with prescribed_rotation, which has global directions, while body_a can rotate"},
      {"generic rigid joint", "<prescribe_Rx>1</prescribe_Rx>",
       "generic rigid joint with 2 free and 1 prescribed rotations"},
      {"generic rigid joint",
       "<prescribe_Rx>2</prescribe_Rx><prescribe_Ry>0</prescribe_Ry><prescribe_Rz>0</prescribe_Rz>",
       "generic rigid joint with prescribe_Rx beyond a right angle"}};
  for (const auto& c : cases) {
    const JointModel m = read(model_and(connector(std::get<0>(c), std::get<1>(c))));
    ASSERT_EQ(m.unsupported.size(), 1u) << std::get<2>(c);
    EXPECT_EQ(m.unsupported[0].what, std::get<2>(c));
  }
  const auto fault_with = [&](const std::string& type, const std::string& inside) {
    const std::string text = fault_of(model_and(connector(type, inside)));
    return text.substr(text.find(' ') + 1);
  };
  EXPECT_EQ(fault_with("rigid cylindrical joint", ""),
            "rigid cylindrical joint without <joint_axis>, which has no default: add it, a direction x,y,z");
  EXPECT_EQ(fault_with("rigid prismatic joint", "<translation_axis>0,1,0</translation_axis>"),
            "rigid prismatic joint: translation_axis and transverse_axis have the same direction, expected two "
            "different ones");
  EXPECT_EQ(fault_with("rigid revolute joint", "<prescribed_rotation>1</prescribed_rotation><moment>1</moment>"),
            "rigid revolute joint with prescribed_rotation = 1 and a moment of 1, expected one of them");
  EXPECT_EQ(fault_of(model_and("<Rigid><rigid_load type=\"rigid_axial_force\"/></Rigid>")).substr(14),
            "<rigid_load> without <rbA>: add it, with the name of a rigid material");
}

TEST_F(ReadFeb, ForcesOnAndBetweenBodies) {
  const JointModel m = read(model_and(
      R"(<Rigid><rigid_load type="rigid_force"><rb>femur</rb><dof>Ry</dof><value>1</value><load_type>TARGET</load_type></rigid_load>
<rigid_load type="rigid_moment"><rb>femur</rb><dof>Rv</dof><value>1</value><relative>1</relative></rigid_load>
<rigid_load type="rigid_follower_force"><rb>femur</rb><insertion>1,2,3</insertion><force lc="2">0,0,4</force><relative>1</relative></rigid_load>
<rigid_load type="rigid_follower_moment"><rb>femur</rb><moment>0,5,0</moment></rigid_load>
<rigid_load type="rigid_axial_force"><rbA>plate</rbA><rbB>femur</rbB><ra>0,0,1</ra><rb>0,0,2</rb><force lc="1">6</force></rigid_load>
<rigid_load type="rigid_cable"><force lc="1">7</force><force_direction>0,3,0</force_direction><relative>0</relative>
<rigid_cable_point><rigid_body_id>plate</rigid_body_id><position>1,0,0</position></rigid_cable_point>
<rigid_cable_point><rigid_body_id>femur</rigid_body_id><position>2,0,0</position></rigid_cable_point></rigid_load>
<rigid_connector type="rigid contractile force"><body_a>1</body_a><body_b>4</body_b><f0 lc="2">8</f0>
<insertion_a>0,0,1</insertion_a><insertion_b>0,0,5</insertion_b></rigid_connector></Rigid>
<Loads><nodal_load type="nodal_load" node_set="side"><dof>y</dof><scale lc="2">9</scale></nodal_load>
<nodal_load type="nodal_force" node_set="held"><value lc="1">1,2,3</value></nodal_load></Loads>)"));
  EXPECT_TRUE(m.unsupported.empty());
  EXPECT_EQ(m.rigid_loads[2].kind, RigidLoad::Kind::Target);
  EXPECT_FALSE(m.rigid_loads[2].relative);
  EXPECT_EQ(m.rigid_loads[3].kind, RigidLoad::Kind::Dead);
  EXPECT_TRUE(m.rigid_loads[3].relative);
  ASSERT_EQ(m.rigid_followers.size(), 2u);
  EXPECT_EQ(m.rigid_followers[0].insertion, Vector3d(1, 2, 3));
  EXPECT_TRUE(m.rigid_followers[0].from_center);
  EXPECT_EQ(m.rigid_followers[0].value, Vector3d(0, 0, 4));
  EXPECT_EQ(m.rigid_followers[0].controller, 1);
  EXPECT_TRUE(m.rigid_followers[1].moment);
  EXPECT_EQ(m.rigid_followers[1].controller, -1);
  ASSERT_EQ(m.rigid_axial_forces.size(), 2u);
  EXPECT_EQ(m.rigid_axial_forces[0].point_b, Vector3d(0, 0, 2));
  EXPECT_EQ(m.rigid_axial_forces[0].force.factor, 6.0);
  EXPECT_EQ(m.rigid_axial_forces[1].material_b, 3);
  EXPECT_EQ(m.rigid_axial_forces[1].force.controller, 1);
  ASSERT_EQ(m.rigid_cables.size(), 1u);
  EXPECT_EQ(m.rigid_cables[0].direction, Vector3d(0, 1, 0));
  EXPECT_FALSE(m.rigid_cables[0].from_centers);
  EXPECT_EQ(m.rigid_cables[0].points.at(1).position, Vector3d(2, 0, 0));
  ASSERT_EQ(m.nodal_forces.size(), 2u);
  EXPECT_EQ(m.nodal_forces[0].value, Vector3d(0, 9, 0));
  EXPECT_EQ(m.nodal_forces[0].nodes, (std::vector<int>{0, 4, 7}));
  EXPECT_EQ(m.nodal_forces[1].value, Vector3d(1, 2, 3));
  EXPECT_EQ(m.nodal_forces[1].controller, 0);
}

// 90 degrees about x, then 90 about z, is 120 degrees about (1,1,1).
TEST_F(ReadFeb, ConstraintsActWhereStepsNameThem) {
  const auto with = [&](const std::string& sections) {
    return read(replaced(kModel25, "</febio_spec>", sections + "</febio_spec>"));
  };
  const auto steps_of = [](const JointModel& m) {
    std::vector<int> steps;
    for (const RigidSpring& s : m.rigid_springs) steps.push_back(s.step);
    return steps;
  };
  const std::string again = R"(<Constraints><constraint name="c"/></Constraints>)";  // given outside steps
  EXPECT_EQ(steps_of(with("")), (std::vector<int>{-1}));
  EXPECT_EQ(steps_of(with("<Step>" + again + "</Step>")), (std::vector<int>{2}));
  EXPECT_EQ(steps_of(with("<Step>" + again + again + "</Step><Step>" + again + "</Step>")), (std::vector<int>{2, 3}));
  EXPECT_THROW(with(R"(<Step><Constraints><constraint name="d"/></Constraints></Step>)"), InputError);
  // moments of a spherical joint are loads: they act with it
  const std::string ball =
      R"(<Constraints><constraint name="b" type="rigid spherical joint"><body_a>1</body_a><body_b>4</body_b>
<joint_origin>0,0,0</joint_origin><moment_x>7</moment_x></constraint></Constraints>)";
  const std::string ball_again = R"(<Constraints><constraint name="b"/></Constraints>)";
  const auto loads_in = [](const JointModel& m, int step) {
    return std::count_if(m.rigid_loads.begin(), m.rigid_loads.end(),
                         [&](const RigidLoad& l) { return l.name == "b" && l.step == step; });
  };
  const std::string empty_step = "<Step></Step>";
  const JointModel twice =
      with("<Step>" + ball + "</Step>" + empty_step + "<Step>" + ball_again + "</Step><Step>" + ball_again + "</Step>");
  for (const int step : {2, 4, 5}) EXPECT_EQ(loads_in(twice, step), 2) << step;
  EXPECT_EQ(loads_in(twice, 3), 0);
  EXPECT_EQ(loads_in(twice, -1), 0);
  ASSERT_EQ(twice.rigid_joints.size(), 3u);
  EXPECT_EQ(twice.rigid_joints[2].step, 5);
  // a section Discrete behind steps acts in all
  const JointModel m = with(
      R"(<Discrete><rigid_axial_force><rbA>1</rbA><rbB>4</rbB><force lc="1">1</force></rigid_axial_force></Discrete>)");
  ASSERT_EQ(m.rigid_axial_forces.size(), 1u);
  EXPECT_EQ(m.rigid_axial_forces[0].step, -1);
}

TEST_F(ReadFeb, EulerAnglesBecomeARotationVector) {
  const auto angles = [&](const char* inside) {
    const JointModel m = read(model_and(
        fmt::format("<Rigid><rigid_bc type=\"rigid_euler_angles\"><rb>femur</rb>{}</rigid_bc></Rigid>", inside)));
    return std::vector<RigidPrescribed>(m.rigid_prescribed.end() - 3, m.rigid_prescribed.end());
  };
  const double third = 2 * M_PI / 3 / std::sqrt(3.0);
  for (const RigidPrescribed& p : angles("<Ex>90</Ex><Ez>90</Ez>")) EXPECT_NEAR(p.value.factor, third, 1e-14);
  const auto one = angles("<Ey lc=\"1\">180</Ey>");
  EXPECT_DOUBLE_EQ(one[1].value.factor, M_PI);
  EXPECT_EQ(one[1].value.controller, 0);
  EXPECT_EQ(one[1].dof, 4);
  EXPECT_EQ(one[0].value.factor, 0.0);
  EXPECT_EQ(one[0].value.controller, -1);
}

TEST_F(ReadFeb, DiscreteSpringsOfEveryKind) {
  const auto last = [&](const std::string& material) {
    const JointModel m =
        read(model_and("<Discrete><discrete_material id=\"3\" " + material +
                       "</discrete_material><discrete dmat=\"3\" discrete_set=\"ligament\"/></Discrete>"));
    EXPECT_TRUE(m.unsupported.empty()) << material << m.unsupported.front().what;
    return m.discrete_springs.back();
  };
  const DiscreteSprings points = last(
      R"(type="nonlinear spring"><scale lc="1">2</scale><measure>strain</measure><force type="point"><interpolate>linear</interpolate><extend>extrapolate</extend><points><pt>0,0</pt><pt>0.1,5</pt></points></force>)");
  EXPECT_EQ(points.measure, DiscreteSprings::Measure::Strain);
  EXPECT_EQ(points.scale.factor, 2.0);
  EXPECT_EQ(points.scale.controller, 0);
  EXPECT_DOUBLE_EQ(value(*points.force, 0.2), 10.0);
  const DiscreteSprings math = last(R"(type="nonlinear spring"><force type="math">2e1*x^2*H(x) + exp(0)-1</force>)");
  EXPECT_DOUBLE_EQ(value(*math.force, 3.0), 180.0);
  EXPECT_DOUBLE_EQ(value(*math.force, -3.0), 0.0);
  EXPECT_EQ(math.scale.factor, 1.0);
  EXPECT_EQ(math.scale.controller, -1);
  const DiscreteSprings curve = last(R"(type="nonlinear spring"><force lc="2">3</force>)");
  EXPECT_DOUBLE_EQ(value(*curve.force, 1.0), 3.0);
  EXPECT_EQ(value(*last(R"(type="nonlinear spring"><force type="const"><value>4</value></force>)").force, 9.0), 4.0);
  EXPECT_EQ(
      value(
          *last(R"(type="nonlinear spring"><force type="linear ramp"><slope>2</slope><intercept>1</intercept></force>)")
               .force,
          -3.0),
      -5.0);
  const DiscreteSprings toe = last(R"(type="experimental spring"><E>10</E><sM>2</sM><sm>3</sm>)");
  EXPECT_NEAR(value(*toe.force, 0.1), 2 * (1 - std::exp(-0.5)), 1e-14);
  EXPECT_NEAR(value(*toe.force, -0.3), -3 * (1 - std::exp(-1.0)), 1e-14);
  const JointModel wire =
      read(model_and("<Discrete><discrete type=\"wire\" dmat=\"1\" discrete_set=\"ligament\"/></Discrete>"));
  EXPECT_EQ(wire.unsupported.at(0).what, "discrete elements of type \"wire\"");
}

TEST_F(ReadFeb, OldNodalForcesHaveOneValuePerNode) {
  const JointModel m12 = read(replaced(
      kModel12, "<Step name=\"one\">",
      R"(<Loads><force><node id="1" bc="x" lc="1">2</node><node id="2" bc="x" lc="1">2</node><node id="3" bc="y" lc="2">3</node></force></Loads><Step name="one">)"));
  const JointModel m20 = read(replaced(
      kModel20, "<Step name=\"one\">",
      R"(<Loads><nodal_load bc="x" lc="1" scale="2" set="pair"/><nodal_load bc="y" lc="2"><node id="3">3</node></nodal_load></Loads><Step name="one">)"));
  for (const JointModel* m : {&m12, &m20}) {
    ASSERT_EQ(m->nodal_forces.size(), 2u);
    EXPECT_EQ(m->nodal_forces[0].value, Vector3d(2, 0, 0));
    EXPECT_EQ(m->nodal_forces[0].nodes, (std::vector<int>{0, 1}));
    EXPECT_EQ(m->nodal_forces[0].controller, 0);
    EXPECT_EQ(m->nodal_forces[1].value, Vector3d(0, 3, 0));
    EXPECT_EQ(m->nodal_forces[1].controller, 1);
  }
}

TEST_F(ReadFeb, MaterialConstantsMayBeExpressions) {
  const JointModel m = read(model_with("<E>10</E>", "<E type=\"math\">2*(1+4)</E>"));
  EXPECT_DOUBLE_EQ(m.materials[1].E, 10.0);
}

TEST_F(ReadFeb, FaultsOfOldFilesHaveTheirLine) {
  const auto old = [&](const std::string& model, const std::string& from, const std::string& to) {
    return fault_of(replaced(model, from, to));
  };
  EXPECT_EQ(old(kModel20, "name=\"lower\"", "name=\"upper\""),
            "model.feb:18: several materials are called \"upper\": name it by its id");
  EXPECT_EQ(old(kModel20, "<surface type=\"slave\" set=\"bottom\"/>",
                "<surface type=\"slave\" set=\"bottom\"/><surface type=\"slave\" set=\"bottom\"/>"),
            "model.feb:26: contact with two slave surfaces, expected one");
  EXPECT_EQ(old(kModel20, "<node>1,18</node>", ""),
            "model.feb:30: spring without <node>n1,n2</node>: add the nodes it joins");
  EXPECT_EQ(
      old(kModel12, ">1,6<", ">1<"),
      "model.feb:25: quad4 facet 1 of surface \"contact 1 slave\" is \"1\", expected the number of an element and of "
      "its face");
  EXPECT_EQ(old(kModel12, "format=\"element face\"", "format=\"faces\""),
            "model.feb:25: format = \"faces\", expected face nodes or element face");
  EXPECT_EQ(old(kModel30, "elem_set=\"P\"", "elem_set=\"Q\""),
            "model.feb:29: elem_set = \"Q\", expected the name of an ElementSet or Elements section; the model has "
            "\"L\", \"P\", \"U\"");
  EXPECT_EQ(old(kModel30, "<elem lid=\"1\">", "<elem lid=\"2\">"),
            "model.feb:29: lid = 2, but the element set has 1 elements: mend the number");
  EXPECT_EQ(old(kModel20, "set=\"bottom\"", "set=\"under\""),
            "model.feb:26: set = \"under\", expected the name of a Surface above it; the model has \"bottom\", \"joint "
            "master\"");
  EXPECT_EQ(old(kModel20, "<surface type=\"slave\" set=\"bottom\"/>", ""),
            "model.feb:25: contact without <surface type=\"slave\">: add it");
  EXPECT_EQ(
      old(kModel12, ">1,6<", ">1,7<"),
      "model.feb:25: quad4 facet 1 of surface \"contact 1 slave\": element 1 has no such face 7, expected 1 to 6");
  EXPECT_EQ(old(kModel12, "<hex8 id=\"7\" mat=\"2\">", "<hex8 id=\"7\" mat=\"9\">"),
            "model.feb:17: <hex8> with mat = \"9\", expected the id of a material");
  EXPECT_EQ(old(kModel12, "<element id=\"2\">", "<element id=\"9\">"),
            "model.feb:19: ElementData of element 9, which does not exist: take it out");
  EXPECT_EQ(
      old(kModel12, "rb=\"4\"", "rb=\"2\""),
      "model.feb:21: material \"lower\" is \"neo-Hookean\", expected a rigid body; rigid bodies: \"plate\", \"femur\"");
}

TEST_F(ReadFeb, NodesOutOfOrderAreFound) {
  const JointModel m = read(feb("3.0",
                                "<Mesh><Nodes name=\"n\"><node id=\"7\">7,0,0</node><node id=\"3\">3,0,0</node><node "
                                "id=\"5\">5,0,0</node></Nodes>"
                                "<Elements type=\"tri3\" name=\"e\"><elem id=\"1\">3,5,7</elem></Elements></Mesh>"));
  EXPECT_EQ(m.domains[0].nodes, (std::vector<int>{1, 2, 0}));
  EXPECT_EQ(m.node_ids, (std::vector<int>{7, 3, 5}));
}

// Whatever happens to a file, it is read or refused in one line; nothing else may come out.
TEST_F(ReadFeb, DamagedFilesAreReadOrRefusedInOneLine) {
  int refused = 0, tried = 0;
  const auto try_text = [&](const std::string& text) {
    ++tried;
    try {
      read_feb(write("model.feb", text));
    } catch (const InputError& error) {
      ++refused;
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
  };
  std::mt19937 random(1);
  for (const std::string& model : {kModel12, kModel20, kModel25, kModel30, kModel40}) {
    for (std::size_t size = 0; size + 20 < model.size(); size += 37) {
      const int before = refused;
      try_text(model.substr(0, size));
      EXPECT_EQ(refused, before + 1) << "cut at " << size;
    }
    for (int i = 0; i < 700; ++i) {
      std::string text = model;
      for (int flips = 1 + i % 3; flips > 0; --flips) text[random() % text.size()] = static_cast<char>(random() % 256);
      try_text(text);
    }
    for (int i = 0; i < 700; ++i) {  // digits and letters exchanged: well-formed XML with other contents
      std::string text = model;
      const std::size_t at = random() % text.size();
      if (std::isalnum(static_cast<unsigned char>(text[at])) == 0) continue;
      text[at] = "0123456789-+.exyz"[random() % 17];
      try_text(text);
    }
    for (int i = 0; i < 200; ++i) {  // a piece missing
      std::string text = model;
      text.erase(random() % text.size(), random() % 200);
      try_text(text);
    }
  }
  EXPECT_GT(tried, 4000);
  EXPECT_GT(refused, tried / 3);
}

// -- a contact of type dea ----------------------------------------------------------------------------

const std::string kDeaContact = R"(<Contact><contact name="joint" type="dea" surface_pair="pair">
<law>NEO-hookean</law><facets>flat</facets><source>secondary</source><refine>2</refine>
<primary_E>11.85</primary_E><primary_nu>0.45</primary_nu><primary_thickness type="map">bottom h</primary_thickness>
<secondary_thickness>0</secondary_thickness></contact></Contact>
)";
const std::string kDeaMaps = R"(<MeshData><SurfaceData name="bottom h" surface="bottom" data_type="scalar">
<face lid="1">1,2,3,4.5</face></SurfaceData>
<SurfaceData name="other" surface="top" data_type="vec3"><face lid="1">x</face></SurfaceData></MeshData>
)";
const std::string kDeaMesh40 = kMaterials + kMesh30 + kPair30 + kDomains;

std::string dea_model(const std::string& maps = kDeaMaps, const std::string& contact = kDeaContact) {
  return feb("4.0", kDeaMesh40 + maps + contact);
}

TEST_F(ReadFeb, ContactOfTypeDea) {
  for (const std::string version : {"4.0", "3.0"}) {
    std::string text = feb(version, kDeaMesh40 + kDeaMaps + kDeaContact);
    if (version == "3.0") text = replaced(text, "data_type=\"scalar\"", "datatype=\"scalar\"");
    const JointModel m = read(text);
    ASSERT_EQ(m.contacts.size(), 1u);
    const Contact& c = m.contacts[0];
    EXPECT_EQ(c.kind, Contact::Kind::Sliding);
    EXPECT_EQ(c.type, "dea");
    ASSERT_TRUE(c.dea);
    EXPECT_EQ(c.dea->law, Law::NeoHookean);
    EXPECT_EQ(c.dea->facets, Facets::Flat);
    EXPECT_EQ(c.dea->source, 1);
    EXPECT_EQ(c.dea->refine, 2);
    EXPECT_EQ(c.dea->layers[0].E, 11.85);
    EXPECT_EQ(c.dea->layers[0].nu, 0.45);
    EXPECT_FALSE(c.dea->layers[0].thickness);
    EXPECT_EQ(c.dea->layers[0].thickness_map, (std::vector<double>{1, 2, 3, 4.5}));
    EXPECT_EQ(c.dea->layers[1].thickness, 0.0);
    EXPECT_TRUE(c.dea->layers[1].thickness_map.empty());
    EXPECT_FALSE(c.dea->layers[1].E);
    // The other map is nobody's: ignored, whatever it holds.
    EXPECT_EQ(std::count_if(m.ignored.begin(), m.ignored.end(),
                            [](const Remark& r) { return r.what.rfind("SurfaceData", 0) == 0 && r.count == 1; }),
              1);
  }
  const JointModel bare =
      read(dea_model("", "<Contact><contact name=\"j\" type=\"dea\" surface_pair=\"pair\"/></Contact>"));
  ASSERT_TRUE(bare.contacts[0].dea);
  EXPECT_FALSE(bare.contacts[0].dea->law || bare.contacts[0].dea->facets || bare.contacts[0].dea->refine);
}

// Facets of a surface may differ; FEBio stores as many values for each as the largest has nodes.
TEST_F(ReadFeb, MapOnTrianglesAndQuads) {
  const std::string mixed = replaced(dea_model(), "<quad4 id=\"1\">5,6,7,8</quad4>",
                                     "<quad4 id=\"1\">5,6,7,8</quad4><tri3 id=\"2\">11,12,13</tri3><tri3 "
                                     "id=\"3\">11,13,14</tri3>");
  const std::string face = "<face lid=\"1\">1,2,3,4.5</face>";
  const JointModel m =
      read(replaced(mixed, face, "<face lid=\"3\">7</face>" + face + "<face lid=\"2\">4, 5 ,6,\n6</face>"));
  EXPECT_EQ(m.contacts[0].dea->layers[0].thickness_map, (std::vector<double>{1, 2, 3, 4.5, 4, 5, 6, 7, 7, 7}));
  EXPECT_NE(fault_of(replaced(mixed, face, face + "<face lid=\"2\">4,5,6</face>")).find("expected one number, or 4"),
            std::string::npos);
}

TEST_F(ReadFeb, FaultsOfAContactOfTypeDea) {
  const auto contact = [&](const std::string& from, const std::string& to) {
    return fault_of(dea_model(kDeaMaps, replaced(kDeaContact, from, to)));
  };
  EXPECT_EQ(contact("NEO-hookean", "Ogden"),
            "model.feb:28: law = \"Ogden\", expected one of linear, logarithmic, neo-Hookean, layer");
  EXPECT_EQ(contact("flat", "round"), "model.feb:28: facets = \"round\", expected one of curved, flat");
  EXPECT_EQ(contact(">secondary<", ">both<"), "model.feb:28: source = \"both\", expected one of primary, secondary");
  EXPECT_EQ(contact("<refine>2", "<refine>0"), "model.feb:28: refine = 0, need 1 to 1000");
  EXPECT_EQ(contact("<law>NEO-hookean</law>", "<penalty>1</penalty>"),
            "model.feb:28: <penalty> in a contact of type dea, expected law, facets, source, refine, symmetry_planes, "
            "or E, nu, "
            "thickness with primary_ or secondary_ before");
  const std::pair<const char*, std::vector<SymmetryPlane>> stated[] = {
      {"", {}}, {" ", {}}, {"x=0", {{0, 0}}}, {" x = -1.5e1 ,z=2", {{0, -15}, {2, 2}}}, {"y=-0", {{1, 0}}}};
  for (const auto& [planes, expected] : stated) {
    const std::string text = fmt::format("<symmetry_planes>{}</symmetry_planes><refine>2", planes);
    EXPECT_EQ(read(dea_model(kDeaMaps, replaced(kDeaContact, "<refine>2", text))).contacts[0].dea->symmetry_planes,
              expected)
        << planes;
  }
  for (const char* planes : {"x", "x=", "=0", "w=0", "x:0", "x=0,", ",x=0", "x=0;y=0", "x=nan", "x=0 y=0", "xy=0"})
    EXPECT_EQ(contact("<refine>2", fmt::format("<symmetry_planes>{}</symmetry_planes><refine>2", planes)),
              fmt::format("model.feb:28: symmetry_planes = \"{}\", expected planes across axes, as in \"x=0, y=-12.5\"",
                          planes));
  EXPECT_EQ(contact("11.85", "0"), "read without a fault");  // FEBio's defaults, written out: not given
  EXPECT_EQ(contact(">0<", ">-1<"), "read without a fault");
  EXPECT_EQ(contact("11.85", "-1"), "model.feb:29: primary_E = -1, need E > 0");
  EXPECT_EQ(contact("0.45", "0.5"), "model.feb:29: primary_nu = 0.5, need -1 < nu < 0.5");
  EXPECT_EQ(contact("0.45", "-1"), "model.feb:29: primary_nu = -1, need -1 < nu < 0.5");
  EXPECT_EQ(contact(">0<", ">-2<"), "model.feb:30: secondary_thickness = -2, need thickness >= 0");
  EXPECT_EQ(contact(">0<", ">1,8<"),
            "model.feb:30: secondary_thickness = \"1,8\", expected a number with a decimal point");
  EXPECT_EQ(contact(">0<", ">X+1<"),
            "model.feb:30: \"X+1\" names no map, expected the name of a SurfaceData in MeshData");
  EXPECT_EQ(contact(" type=\"map\">bottom h", ">bottom h"), "read without a fault");
  EXPECT_EQ(contact(">0<", "><"), "read without a fault");
  EXPECT_EQ(contact(">0<", " type=\"map\">1.8<"),
            "model.feb:30: \"1.8\" names no map, expected the name of a SurfaceData in MeshData");
  const std::string digit = replaced(kDeaContact, " type=\"map\">bottom h", ">3T_map");
  EXPECT_EQ(fault_of(dea_model(replaced(kDeaMaps, "bottom h", "3T_map"), digit)), "read without a fault");
  EXPECT_EQ(contact(" type=\"map\">bottom h", " type=\"math\">X"),
            "model.feb:29: primary_thickness is given as type \"math\" or follows a load controller, expected a number "
            "or type \"map\"");
  EXPECT_EQ(contact("bottom h", "none"),
            "model.feb:29: \"none\" names no map, expected the name of a SurfaceData in MeshData");
  EXPECT_EQ(contact("bottom h", "other"), "model.feb:26: SurfaceData \"other\": data_type = \"vec3\", expected scalar");
  EXPECT_EQ(contact("<secondary_thickness>0", "<secondary_thickness type=\"map\">bottom h"),
            "model.feb:30: map \"bottom h\" is of surface \"bottom\", expected one of surface \"top\"");

  const auto map = [&](const std::string& from, const std::string& to) {
    return fault_of(dea_model(replaced(kDeaMaps, from, to)));
  };
  EXPECT_EQ(map("surface=\"bottom\"", "surface=\"under\""),
            "model.feb:24: SurfaceData \"bottom h\": surface = \"under\", expected the name of a Surface");
  EXPECT_EQ(
      map("data_type=\"scalar\"", "type=\"const\""),
      "model.feb:24: SurfaceData \"bottom h\": its values are made by a generator, expected <face lid=\"1\"> with "
      "numbers for every facet");
  EXPECT_EQ(map("1,2,3,4.5", "1,2,3"),
            "model.feb:25: SurfaceData \"bottom h\": facet 1 has \"1,2,3\", expected one number, or 4: as many as the "
            "surface's largest facet has nodes");
  EXPECT_EQ(map("1,2,3,4.5", "1,2,3,nan"),
            "model.feb:25: SurfaceData \"bottom h\": facet 1 has \"1,2,3,nan\", expected numbers of at most 1e30");
  EXPECT_EQ(
      map("lid=\"1\">1,2", "lid=\"2\">1,2"),
      "model.feb:25: SurfaceData \"bottom h\": <face> with lid = \"2\", expected the number of one of the 1 facets "
      "of surface \"bottom\"");
  EXPECT_EQ(map("<face lid=\"1\">1,2,3,4.5</face>", ""),
            "model.feb:24: SurfaceData \"bottom h\": facet 1 of surface \"bottom\" has no value (1 such facets)");
  EXPECT_EQ(map("</face></SurfaceData>", "</face><face lid=\"1\">1</face></SurfaceData>"),
            "model.feb:25: SurfaceData \"bottom h\": facet 1 is given twice");
  EXPECT_EQ(map("1,2,3,4.5", "1,2,-3,4.5"),
            "model.feb:24: SurfaceData \"bottom h\" has a thickness of -3, need thickness >= 0");
}

// -- models of others --------------------------------------------------------------------------------

TEST(ReferenceModels, AreReadWhole) {
  if (!fs::is_directory(DEA_REFERENCE_DIR)) GTEST_SKIP() << "no " << DEA_REFERENCE_DIR;
  int count = 0;
  for (const auto& entry : fs::directory_iterator(DEA_REFERENCE_DIR)) {
    if (entry.path().extension() != ".feb") continue;
    ++count;
    const JointModel m = read_feb(entry.path().string());
    EXPECT_TRUE(m.unsupported.empty()) << entry.path();
    EXPECT_TRUE(m.ignored.empty()) << entry.path();
    EXPECT_EQ(m.contacts.size(), 1u);
    EXPECT_EQ(m.steps.size(), 2u);
    EXPECT_GT(m.nodes.size(), 1000u);
    for (const Material& a : m.materials) EXPECT_TRUE(a.rigid || a.nu == 0.45) << a.name;
  }
  EXPECT_GT(count, 0);
}

/// Corpus models by problem and version. Empty without the corpus.
std::map<std::string, std::map<std::string, std::string>> corpus() {
  std::map<std::string, std::map<std::string, std::string>> problems;
  for (const char* version : {"v1.2", "v2.0", "v2.5", "v3.0", "v4.0"}) {
    const fs::path folder = fs::path(DEA_CORPUS_DIR) / version;
    if (!fs::is_directory(folder)) continue;
    for (const auto& entry : fs::directory_iterator(folder)) {
      if (entry.path().extension() == ".feb") problems[entry.path().stem().string()][version] = entry.path().string();
    }
  }
  return problems;
}

TEST(CorpusModels, AllAreRead) {
  if (!fs::is_directory(DEA_CORPUS_DIR)) GTEST_SKIP() << "no " << DEA_CORPUS_DIR;
  std::map<std::string, int> count;
  for (const auto& problem : corpus()) {
    for (const auto& file : problem.second) {
      try {
        const JointModel m = read_feb(file.second);
        ++count[file.first + (m.unsupported.empty() ? " read" : " read, something unsupported")];
        EXPECT_FALSE(m.nodes.empty()) << file.second;
        EXPECT_FALSE(m.steps.empty()) << file.second;
      } catch (const InputError& error) {
        ADD_FAILURE() << error.what();
      }
    }
  }
  for (const auto& entry : count) std::cout << entry.first << ": " << entry.second << "\n";
  EXPECT_GT(count["v4.0 read"], 0);
}

/// Files in which their authors have another mesh or thickness.
const std::set<std::string> kOtherModel = {"v1.2 sh07", "v2.0 sh29"};
/// Problems whose authors shortened the analysis in the 4.0 file.
const std::set<std::string> kShorterIn40 = {"cf09", "co28", "co56", "co58", "dm17", "fs22"};

TEST(CorpusModels, TheSameProblemIsTheSameInEveryFormat) {
  if (!fs::is_directory(DEA_CORPUS_DIR)) GTEST_SKIP() << "no " << DEA_CORPUS_DIR;
  int compared = 0;
  // Parameters and module names were reworked from format to format.
  const std::set<std::string> except = {"contact parameters", "module"};
  const std::set<std::string> except_steps = {"contact parameters", "module", "steps"};
  // The oldest files leave out names or give one name to several materials.
  const std::set<std::string> except_old = {"contact parameters", "module", "material names"};
  for (const auto& problem : corpus()) {
    const auto& files = problem.second;
    if (files.count("v3.0") == 0) continue;
    const Facts v30 = facts_of(read_feb(files.at("v3.0")));
    if (files.count("v4.0") > 0) {
      ++compared;
      EXPECT_EQ(differences(v30, facts_of(read_feb(files.at("v4.0"))),
                            kShorterIn40.count(problem.first) > 0 ? except_steps : except),
                "")
          << problem.first << " 3.0 - 4.0";
    }
    for (const char* version : {"v2.5", "v2.0", "v1.2"}) {
      if (files.count(version) == 0 || kOtherModel.count(version + (" " + problem.first)) > 0) continue;
      ++compared;
      const bool old = version != std::string("v2.5");
      EXPECT_EQ(differences(v30, facts_of(read_feb(files.at(version))), old ? except_old : except), "")
          << problem.first << " 3.0 - " << version;
    }
  }
  EXPECT_GT(compared, 100);
}

}  // namespace dea::read_feb_test
