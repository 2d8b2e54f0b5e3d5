#include "io/build/joint_feb.h"

#include <fmt/format.h>

#include "io/files/encoded_text.h"
#include "src/base/numbers.h"

namespace dea {

namespace {

using Eigen::Vector3d;

constexpr const char* kDirections[] = {"x", "y", "z"};

std::string text(const Vector3d& v) { return fmt::format("{},{},{}", v.x() + 0.0, v.y() + 0.0, v.z() + 0.0); }

/// The mesh in the making: numbers are 1-based.
struct MeshText {
  std::string nodes, elements, surfaces, pairs, domains;
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

std::string held(const BuiltBody& body) {
  std::string all =
      fmt::format("<rigid_bc name=\"{0} held\" type=\"rigid_fixed\">\n<rb>{0}</rb>\n", escaped(body.name));
  for (std::size_t c = 0; c < 3; ++c)
    all += fmt::format("<R{0}_dof>{1}</R{0}_dof>\n", kDirections[c], body.fixed || body.held[c] ? 1 : 0);
  for (const char dof : {'u', 'v', 'w'}) all += fmt::format("<R{}_dof>1</R{}_dof>\n", dof, dof);
  return all + "</rigid_bc>\n";
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

/// Load controllers. 1: rises to 1 over the first step. Several loads: 2 has their times as points that FEBio must
/// meet; from 3 on, three for each loaded body, the components of its force: those of load i at time 2 + i, the first
/// from the start, straight lines between.
std::string controllers(const BuiltJoint& joint) {
  int id = 0;
  std::string all = "<LoadData>\n";
  const auto add = [&](const std::string& name, const std::string& points) {
    all += fmt::format(
        "<load_controller id=\"{}\" name=\"{}\" type=\"loadcurve\">\n<interpolate>LINEAR</interpolate>\n"
        "<extend>CONSTANT</extend>\n<points>\n{}</points>\n</load_controller>\n",
        ++id, name, points);
  };
  add("ramp", "<pt>0,0</pt>\n<pt>1,1</pt>\n");
  const std::size_t loads = joint.loads();
  if (loads > 1) {
    std::string times = "<pt>0,1</pt>\n";
    for (std::size_t i = 0; i < loads; ++i) times += fmt::format("<pt>{},1</pt>\n", i + 2);
    add("times of the loads", times);
    for (const BuiltBody& body : joint.bodies) {
      if (body.fixed) continue;
      for (int c = 0; c < 3; ++c) {
        std::string points = fmt::format("<pt>0,{}</pt>\n", force_of(body, 0)[c]);
        for (std::size_t i = 0; i < loads; ++i) points += fmt::format("<pt>{},{}</pt>\n", i + 2, force_of(body, i)[c]);
        add(fmt::format("{} force {}", escaped(body.name), kDirections[c]), points);
      }
    }
  }
  return all + "</LoadData>\n";
}

std::string steps(const BuiltJoint& joint, const BuiltModelSettings& s) {
  const std::size_t loads = joint.loads();
  std::string seat, load;
  int controller = 2;
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    const BuiltBody& body = joint.bodies[b];
    if (body.fixed) continue;
    for (int c = 0; c < 3; ++c) {
      ++controller;
      if (body.held[at(c)]) continue;
      seat += fmt::format(
          "<rigid_bc name=\"{0} seat {1}\" type=\"rigid_displacement\">\n<rb>{0}</rb>\n<dof>{1}</dof>\n<value "
          "lc=\"1\">{2}</value>\n"
          "<relative>0</relative>\n</rigid_bc>\n",
          escaped(body.name), kDirections[c], s.seat.empty() ? 0.0 : s.seat[b][c]);
      load += fmt::format(
          "<rigid_load name=\"{0} force {1}\" type=\"rigid_force\">\n<rb>{0}</rb>\n<dof>R{1}</dof>\n<value "
          "lc=\"{3}\">{2}</value>\n"
          "<load_type>LOAD</load_type>\n<relative>0</relative>\n</rigid_load>\n",
          escaped(body.name), kDirections[c], loads > 1 ? 1.0 : body.force[c], loads > 1 ? controller : 1);
    }
  }
  return "<Step>\n<step id=\"1\" name=\"seat\">\n" + control(20, 1.0 / 20, "") + "<Rigid>\n" + seat +
         "</Rigid>\n</step>\n<step id=\"2\" name=\"load\">\n" + control(loads, 1, loads > 1 ? " lc=\"2\"" : "") +
         "<Rigid>\n" + load + "</Rigid>\n</step>\n</Step>\n";
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
  std::string all = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  if (!s.comment.empty()) all += fmt::format("<!-- {} -->\n", s.comment);
  all += fmt::format("<febio_spec version=\"4.0\">\n<Module type=\"solid\">\n<units>{}</units>\n</Module>\n", s.units);
  all += "<Globals>\n<Constants>\n<T>0</T>\n<R>0</R>\n<Fc>0</Fc>\n</Constants>\n</Globals>\n<Material>\n" +
         materials(joint, s) + "</Material>\n";
  all += "<Mesh>\n" + mesh.nodes + mesh.elements + mesh.surfaces + mesh.pairs + "</Mesh>\n<MeshDomains>\n" +
         mesh.domains + "</MeshDomains>\n<Rigid>\n";
  for (const BuiltBody& body : joint.bodies) all += held(body);
  all += "</Rigid>\n" + contacts(joint, s) + steps(joint, s);
  all += controllers(joint) + "<Output>\n<plotfile type=\"febio\">\n";
  for (const char* variable : {"displacement", "stress", "contact pressure", "contact gap", "contact force",
                               "contact area", "rigid force", "rigid position"})
    all += fmt::format("<var type=\"{}\"/>\n", variable);
  return all + "</plotfile>\n</Output>\n</febio_spec>\n";
}

}  // namespace dea
