#include "io/build/joint_feb.h"

#include <fmt/format.h>

#include <algorithm>

#include "io/files/encoded_text.h"
#include "src/base/numbers.h"

namespace dea {

namespace {

using Eigen::Vector3d;

constexpr const char* kDirections[] = {"x", "y", "z"};
constexpr char kDofLetters[] = {'x', 'y', 'z', 'u', 'v', 'w'};  // after an R

/// Does a force act on it? Not on a bone that only a table moves, or that only its ligaments hold.
bool is_loaded(const BuiltBody& body) {
  const auto some = [](const std::vector<Vector3d>& all) {
    return std::any_of(all.begin(), all.end(), [](const Vector3d& v) { return !v.isZero(0); });
  };
  return !body.fixed && (!body.force.isZero(0) || some(body.forces) || some(body.moments));
}

std::string text(const Vector3d& v) { return fmt::format("{},{},{}", v.x() + 0.0, v.y() + 0.0, v.z() + 0.0); }

/// The mesh in the making: numbers are 1-based.
struct MeshText {
  std::string nodes, elements, surfaces, pairs, sets, domains;
  int node_count = 0, element_count = 0;

  /// Number of the first node less one.
  int add_nodes(const std::string& name, const std::vector<Vector3d>& points) {
    const int before = node_count;
    nodes += fmt::format("<Nodes name=\"{}\">\n", name);
    for (const Vector3d& x : points) nodes += fmt::format("<node id=\"{}\">{}</node>\n", ++node_count, text(x));
    nodes += "</Nodes>\n";
    return before;
  }
  void add_shells(const std::string& name, const std::string& material,
                  const std::vector<std::array<int, 3>>& triangles, int first) {
    elements += fmt::format("<Elements type=\"tri3\" name=\"{}\">\n", name);
    for (const auto& t : triangles)
      elements += fmt::format("<elem id=\"{}\">{},{},{}</elem>\n", ++element_count, first + t[0] + 1, first + t[1] + 1,
                              first + t[2] + 1);
    elements += "</Elements>\n";
    domains += fmt::format("<ShellDomain name=\"{}\" mat=\"{}\"><shell_thickness>0</shell_thickness></ShellDomain>\n",
                           name, material);
  }
  void add_surface(const std::string& name, const std::vector<std::array<int, 3>>& triangles, int first) {
    surfaces += fmt::format("<Surface name=\"{}\">\n", name);
    int id = 0;
    for (const auto& t : triangles)
      surfaces +=
          fmt::format("<tri3 id=\"{}\">{},{},{}</tri3>\n", ++id, first + t[0] + 1, first + t[1] + 1, first + t[2] + 1);
    surfaces += "</Surface>\n";
  }
};

void add_layer(MeshText& mesh, const BuiltLayer& layer, const std::string& bone, int through) {
  const std::string name = escaped(layer.name);
  if (layer.bare) {
    const int first = mesh.add_nodes(name, layer.articular);
    mesh.add_shells(name, bone, layer.triangles, first);
    mesh.add_surface(name + "_surface", layer.triangles, first);
    return;
  }
  std::vector<int> sheets;
  for (int sheet = 0; sheet <= through; ++sheet) {
    std::vector<Vector3d> points = layer.bone;
    for (std::size_t v = 0; v < points.size(); ++v)
      points[v] = sheet == through ? layer.articular[v]
                                   : Vector3d(points[v] + (layer.articular[v] - points[v]) * sheet / through);
    sheets.push_back(mesh.add_nodes(fmt::format("{}_nodes_{}", name, sheet), points));
  }
  mesh.elements += fmt::format("<Elements type=\"penta6\" name=\"{}\">\n", name);
  for (int sheet = 0; sheet < through; ++sheet)
    for (const auto& t : layer.triangles) {
      mesh.elements += fmt::format("<elem id=\"{}\">", ++mesh.element_count);
      for (const int s : {sheet, sheet + 1})
        for (const int v : t)
          mesh.elements += fmt::format("{}{}", sheets[at(s)] + v + 1, s > sheet && &v == &t[2] ? "" : ",");
      mesh.elements += "</elem>\n";
    }
  mesh.elements += "</Elements>\n";
  mesh.domains += fmt::format("<SolidDomain name=\"{}\" mat=\"cartilage\"/>\n", name);
  mesh.add_shells(name + "_bone", bone, layer.triangles, sheets.front());
  mesh.add_surface(name + "_articular", layer.triangles, sheets.back());
}

std::string surface_name(const BuiltLayer& layer) {
  return escaped(layer.name) + (layer.bare ? "_surface" : "_articular");
}

std::string materials(const BuiltJoint& joint, const BuiltModelSettings& s) {
  int id = 0;
  std::string all = fmt::format(
      "<material id=\"{}\" name=\"cartilage\" "
      "type=\"neo-Hookean\">\n<density>1</density>\n<E>{}</E>\n<v>{}</v>\n</material>\n",
      ++id, s.E, s.nu);
  for (const BuiltBody& body : joint.bodies)
    all += fmt::format(
        "<material id=\"{}\" name=\"{}\" type=\"rigid "
        "body\">\n<density>1</density>\n<center_of_mass>{}</center_of_mass>\n</material>\n",
        ++id, escaped(body.name), text(body.center));
  return all;
}

/// FEBio opens a dof when a step ends that has moved it, also one that is held outside steps: the rotations of a body
/// that is seated turned are held in the next step only.
bool held_throughout(const BuiltBody& body, std::size_t dof) {
  if (body.fixed) return true;
  return body.held[dof] && !body.moved[dof] && (dof < 3 || !body.turns_freely());
}

bool held_under_load(const BuiltBody& body, std::size_t dof) {
  return dof >= 3 && body.turns_freely() && body.held[dof];
}

template <class Held>
std::string fixed_dofs(const BuiltBody& body, const char* what, Held held) {
  std::string all =
      fmt::format("<rigid_bc name=\"{0} {1}\" type=\"rigid_fixed\">\n<rb>{0}</rb>\n", escaped(body.name), what);
  bool any = false;
  for (std::size_t k = 0; k < kDofs; ++k) {
    any = any || held(body, k);
    all += fmt::format("<R{0}_dof>{1}</R{0}_dof>\n", kDofLetters[k], held(body, k) ? 1 : 0);
  }
  return any ? all + "</rigid_bc>\n" : "";
}

/// A dof that follows value times controller.
std::string moved_dof(const BuiltBody& body, const char* what, std::size_t dof, double value, int controller) {
  return fmt::format(
      "<rigid_bc name=\"{0} {1} {2}\" type=\"{3}\">\n<rb>{0}</rb>\n<dof>{2}</dof>\n<value "
      "lc=\"{4}\">{5}</value>\n"
      "<relative>0</relative>\n</rigid_bc>\n",
      escaped(body.name), what, kDofNames[dof], dof < 3 ? "rigid_displacement" : "rigid_rotation", controller,
      value + 0.0);
}

/// A force or moment of value times controller.
std::string load_on(const BuiltBody& body, std::size_t dof, double value, int controller) {
  return fmt::format(
      "<rigid_load name=\"{0} {1} {2}\" type=\"rigid_{1}\">\n<rb>{0}</rb>\n<dof>R{3}</dof>\n<value "
      "lc=\"{5}\">{4}</value>\n"
      "<load_type>LOAD</load_type>\n<relative>0</relative>\n</rigid_load>\n",
      escaped(body.name), dof < 3 ? "force" : "moment", kDirections[dof % 3], kDofLetters[dof], value, controller);
}

/// As the solver of the models FEBio has been seen to solve. `must_points`: load controller whose points are met.
std::string control(std::size_t states, double step_size, const char* must_points) {
  return fmt::format(
      "<Control>\n<analysis>STATIC</analysis>\n<time_steps>{0}</time_steps>\n<step_size>{1}</step_size>\n"
      "<time_stepper type=\"default\">\n<max_retries>10</max_retries>\n<opt_iter>12</opt_iter>\n<dtmin>0.0001</dtmin>\n"
      "<dtmax{2}>{1}</dtmax>\n</time_stepper>\n<solver "
      "type=\"solid\">\n<symmetric_stiffness>non-symmetric</symmetric_stiffness>\n"
      "<max_refs>30</max_refs>\n<dtol>0.001</dtol>\n<etol>0.01</etol>\n<rtol>0</rtol>\n<lstol>0.9</"
      "lstol>\n<lsmin>0.01</lsmin>\n"
      "<lsiter>5</lsiter>\n<qn_method type=\"BFGS\">\n<max_ups>0</max_ups>\n</qn_method>\n</solver>\n</Control>\n",
      states, step_size, must_points);
}

/// Load controllers. 1: rises to 1 over the first step. With one load all values follow it. Several loads: 2 has their
/// times as points that FEBio must meet; the others are one for each component of force, moment and motion: that of
/// load i at time 2 + i, the first one's force from the start, its pose from time 1 on, straight lines between.
struct Controllers {
  std::string text;
  int count = 0;
  std::vector<std::array<int, kDofs>> load, motion;  ///< per body and dof
  std::vector<std::array<double, kDofs>> load_value, motion_value;

  int add(const std::string& name, const std::string& points) {
    text += fmt::format(
        "<load_controller id=\"{}\" name=\"{}\" type=\"loadcurve\">\n<interpolate>LINEAR</interpolate>\n"
        "<extend>CONSTANT</extend>\n<points>\n{}</points>\n</load_controller>\n",
        ++count, name, points);
    return count;
  }
};

double load_component(const BuiltBody& body, std::size_t load, std::size_t dof) {
  return dof < 3 ? force_of(body, load)[static_cast<int>(dof)] : moment_of(body, load)[static_cast<int>(dof) - 3];
}

double pose_component(const BuiltBody& body, std::size_t load, std::size_t dof) {
  return body.motion[std::min(load, body.motion.size() - 1)][static_cast<int>(dof)];
}

Controllers make_controllers(const BuiltJoint& joint) {
  Controllers c;
  c.add("ramp", "<pt>0,0</pt>\n<pt>1,1</pt>\n");
  const std::size_t loads = joint.loads(), bodies = joint.bodies.size();
  std::array<int, kDofs> ramp;
  ramp.fill(1);
  c.load.assign(bodies, ramp);
  c.motion.assign(bodies, ramp);
  c.load_value.resize(bodies);
  c.motion_value.resize(bodies);
  if (loads > 1) {
    std::string times = "<pt>0,1</pt>\n";
    for (std::size_t i = 0; i < loads; ++i) times += fmt::format("<pt>{},1</pt>\n", i + 2);
    c.add("times of the loads", times);
  }
  for (std::size_t b = 0; b < bodies; ++b) {
    const BuiltBody& body = joint.bodies[b];
    for (std::size_t k = 0; k < kDofs; ++k) {
      const bool has_load = is_loaded(body) && (k < 3 || (!body.moments.empty() && body.turns_freely()));
      if (has_load) {
        c.load_value[b][k] = loads > 1 ? 1.0 : load_component(body, 0, k);
        std::string points = fmt::format("<pt>0,{}</pt>\n", load_component(body, 0, k));
        for (std::size_t i = 0; i < loads; ++i)
          points += fmt::format("<pt>{},{}</pt>\n", i + 2, load_component(body, i, k));
        if (loads > 1)
          c.load[b][k] = c.add(
              fmt::format("{} {} {}", escaped(body.name), k < 3 ? "force" : "moment", kDirections[k % 3]), points);
      }
    }
    for (std::size_t k = 0; k < kDofs; ++k) {
      if (body.fixed || !body.moved[k]) continue;
      c.motion_value[b][k] = loads > 1 ? 1.0 : pose_component(body, 0, k);
      std::string points = fmt::format("<pt>0,0</pt>\n<pt>1,{}</pt>\n", pose_component(body, 0, k));
      for (std::size_t i = 0; i < loads; ++i)
        points += fmt::format("<pt>{},{}</pt>\n", i + 2, pose_component(body, i, k));
      if (loads > 1) c.motion[b][k] = c.add(fmt::format("{} motion {}", escaped(body.name), kDofNames[k]), points);
    }
  }
  return c;
}

/// What holds and moves bodies in all steps.
std::string rigid_conditions(const BuiltJoint& joint, const Controllers& c) {
  std::string all;
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    const BuiltBody& body = joint.bodies[b];
    all += fixed_dofs(body, "held", held_throughout);
    for (std::size_t k = 0; k < kDofs; ++k)
      if (!body.fixed && body.moved[k]) all += moved_dof(body, "motion", k, c.motion_value[b][k], c.motion[b][k]);
  }
  return all;
}

std::string steps(const BuiltJoint& joint, const BuiltModelSettings& s, const Controllers& c) {
  const std::size_t loads = joint.loads();
  std::string seat, load;
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    const BuiltBody& body = joint.bodies[b];
    load += fixed_dofs(body, "held under load", held_under_load);
    for (std::size_t k = 0; k < kDofs; ++k) {
      const std::vector<Vector3d>& to = k < 3 ? s.seat : s.seat_turn;
      if (k < 3 ? body.free(k) : body.turns_freely())  // FEBio takes all three rotations or none
        seat += moved_dof(body, "seat", k, to.empty() ? 0.0 : to[b][static_cast<int>(k % 3)], 1);
      if (body.free(k) && is_loaded(body) && (k < 3 || !body.moments.empty()))
        load += load_on(body, k, c.load_value[b][k], c.load[b][k]);
    }
  }
  return "<Step>\n<step id=\"1\" name=\"seat\">\n" + control(20, 1.0 / 20, "") + "<Rigid>\n" + seat +
         "</Rigid>\n</step>\n<step id=\"2\" name=\"load\">\n" + control(loads, 1, loads > 1 ? " lc=\"2\"" : "") +
         "<Rigid>\n" + load + "</Rigid>\n</step>\n</Step>\n";
}

/// "x - 0.5" without spaces.
std::string less(double offset) {
  return offset < 0 ? fmt::format("(x+{})", -offset) : fmt::format("(x-{})", offset + 0.0);
}

/// The force of a ligament by its elongation from the length as built, for FEBio counts from there. H is 0 below zero:
///   straight  k/L_s H(u) u                        u = x - x_s, zero at the slack length
///   with toe  k/(4 e_l L_s^2) (H(u) u^2 - H(w) w^2)   w: zero where the toe ends; beyond, the squares leave a line
std::string ligament_expression(const BuiltLigament& l) {
  const double length = length_of(l), slack = l.slack_length;
  const std::string u = less(slack - length), w = less(slack * (1 + l.toe_strain) - length);
  if (l.toe_strain == 0) return fmt::format("{0}*H{1}*{1}", l.stiffness / slack, u);
  return fmt::format("{0}*(H{1}*{1}^2-H{2}*{2}^2)", l.stiffness / (2 * l.toe_strain * slack * slack), u, w);
}

std::string ends_name(const BuiltBody& body) { return escaped(body.name) + "_ligament_ends"; }

/// A node of its own for each end, which moves with its bone, and a spring between both.
struct LigamentText {
  std::string boundary, discrete;
};

LigamentText add_ligaments(MeshText& mesh, const BuiltJoint& joint) {
  LigamentText all;
  std::vector<std::array<int, 2>> ends(joint.ligaments.size());
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    std::vector<Vector3d> points;
    std::string numbers;
    for (std::size_t i = 0; i < ends.size(); ++i) {
      const BuiltLigament& l = joint.ligaments[i];
      for (std::size_t side = 0; side < 2; ++side) {
        if ((side == 0 ? l.bone_a : l.bone_b) != static_cast<int>(b)) continue;
        points.push_back(side == 0 ? l.point_a : l.point_b);
        ends[i][side] = mesh.node_count + static_cast<int>(points.size());
        numbers += fmt::format("{}{}", numbers.empty() ? "" : ",", ends[i][side]);
      }
    }
    if (points.empty()) continue;
    mesh.add_nodes(ends_name(joint.bodies[b]) + "_nodes", points);
    mesh.sets += fmt::format("<NodeSet name=\"{}\">{}</NodeSet>\n", ends_name(joint.bodies[b]), numbers);
    all.boundary += fmt::format("<bc name=\"{0}\" type=\"rigid\" node_set=\"{0}\">\n<rb>{1}</rb>\n</bc>\n",
                                ends_name(joint.bodies[b]), escaped(joint.bodies[b].name));
  }
  std::string springs;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const BuiltLigament& l = joint.ligaments[i];
    const std::string name = escaped(l.name);
    mesh.sets +=
        fmt::format("<DiscreteSet name=\"{}\">\n<delem>{},{}</delem>\n</DiscreteSet>\n", name, ends[i][0], ends[i][1]);
    all.discrete += fmt::format(
        "<discrete_material id=\"{}\" name=\"{}\" type=\"nonlinear "
        "spring\">\n<scale>1</scale>\n<measure>elongation</measure>\n<force "
        "type=\"math\">\n<math>{}</math>\n</force>\n</discrete_material>\n",
        i + 1, name, ligament_expression(l));
    springs += fmt::format("<discrete dmat=\"{}\" discrete_set=\"{}\"/>\n", i + 1, name);
  }
  all.discrete += springs;
  return all;
}

std::string section(const char* name, const std::string& content) {
  return content.empty() ? "" : fmt::format("<{0}>\n{1}</{0}>\n", name, content);
}

std::string contacts(const BuiltJoint& joint, const BuiltModelSettings& s) {
  std::string all = "<Contact>\n";
  for (const BuiltContact& c : joint.contacts)
    all += fmt::format(
        "<contact name=\"{0}\" type=\"sliding-elastic\" "
        "surface_pair=\"{0}\">\n<laugon>PENALTY</laugon>\n<penalty>{1}</penalty>\n"
        "<auto_penalty>1</auto_penalty>\n<two_pass>0</two_pass>\n<symmetric_stiffness>0</symmetric_stiffness>\n"
        "<search_radius>1</search_radius>\n<search_tol>0.01</search_tol>\n<fric_coeff>0</fric_coeff>\n</contact>\n",
        escaped(c.name), s.penalty);
  return all + "</Contact>\n";
}

}  // namespace

std::string joint_feb(const BuiltJoint& joint, const BuiltModelSettings& s) {
  MeshText mesh;
  for (const BuiltLayer& layer : joint.layers)
    add_layer(mesh, layer, escaped(joint.bodies[at(layer.body)].name), s.elements_through);
  for (const BuiltBody& body : joint.bodies)
    if (!body.shell.triangles.empty()) {
      const std::string name = escaped(body.name);
      mesh.add_shells(name, name, body.shell.triangles, mesh.add_nodes(name, body.shell.points));
    }
  for (const BuiltContact& c : joint.contacts)
    mesh.pairs += fmt::format(
        "<SurfacePair name=\"{}\">\n<primary>{}</primary>\n<secondary>{}</secondary>\n</SurfacePair>\n",
        escaped(c.name), surface_name(joint.layers[at(c.primary)]), surface_name(joint.layers[at(c.secondary)]));
  const LigamentText ligaments = add_ligaments(mesh, joint);
  const Controllers controllers = make_controllers(joint);
  std::string all = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  if (!s.comment.empty()) all += fmt::format("<!-- {} -->\n", s.comment);
  all += fmt::format("<febio_spec version=\"4.0\">\n<Module type=\"solid\">\n<units>{}</units>\n</Module>\n", s.units);
  all += "<Globals>\n<Constants>\n<T>0</T>\n<R>0</R>\n<Fc>0</Fc>\n</Constants>\n</Globals>\n<Material>\n" +
         materials(joint, s) + "</Material>\n";
  all += "<Mesh>\n" + mesh.nodes + mesh.elements + mesh.surfaces + mesh.sets + mesh.pairs + "</Mesh>\n<MeshDomains>\n" +
         mesh.domains + "</MeshDomains>\n" + section("Boundary", ligaments.boundary) + "<Rigid>\n" +
         rigid_conditions(joint, controllers) + "</Rigid>\n" + contacts(joint, s) +
         section("Discrete", ligaments.discrete) + steps(joint, s, controllers);
  all += "<LoadData>\n" + controllers.text + "</LoadData>\n<Output>\n<plotfile type=\"febio\">\n";
  for (const char* variable : {"displacement", "stress", "contact pressure", "contact gap", "contact force",
                               "contact area", "rigid force", "rigid position"})
    all += fmt::format("<var type=\"{}\"/>\n", variable);
  return all + "</plotfile>\n</Output>\n</febio_spec>\n";
}

}  // namespace dea
