// samples/generate.cpp – writes the joint models of samples/ whose answers are known on paper.
//
//   make_samples SAMPLES_DIR                writes every generated .feb file below SAMPLES_DIR
//   make_samples --spheres N out.feb        one model, N (even) quads along an edge: 3 N^2 on the hemisphere
//                --twisted-spheres            the same, the ball's mesh turned so that facets do not coincide
//                --two-layer-spheres          3 N^2 on each hemisphere
//                --sphere-on-flat             N^2 on the layer
//                --plateaus                   N^2 on each plateau
//                --ligament                   N^2 on the layer
//                --knee                       about 10 N^2 springs in four contacts
//                --menisci                    N^2 on each plateau and condyle
//                --chain                      N^2 quads on each of 18 surfaces
//
// mm, N, MPa. The same command writes the same bytes. samples/hip/hip_walking.feb is not made here.
#include <fmt/core.h>
#include <fmt/format.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using Eigen::Vector3d;
using Quad = std::array<int, 4>;

constexpr double kPi = 3.14159265358979323846;

// ---------------------------------------------------------------------------------------------------------------------
// Meshes

/// A surface patch: points, and quads counter-clockwise seen from outside (from +z, from far away).
struct Patch {
  std::vector<Vector3d> points;
  std::vector<Quad> quads;
};

/// Unit sphere around the origin, z >= 0, as the upper half of a cube whose lines are spread evenly in angle: no
/// quad is degenerate, and the rim is the circle z = 0. n (even): quads along an edge of the cube. Then `below`
/// rows of quads under the rim, whose points and quads come last.
Patch hemisphere(int n, int below) {
  Patch patch;
  std::map<std::array<int, 3>, int> index;  // by lattice coordinates -n .. n on the cube, in steps of 2
  const auto coordinate = [n](int lattice) {
    if (std::abs(lattice) == n) return lattice < 0 ? -1.0 : 1.0;
    const double value = std::tan(kPi / 4 * std::abs(lattice) / n);
    return lattice < 0 ? -value : value;
  };
  const auto point = [&](int i, int j, int k) {
    const auto [place, is_new] = index.try_emplace({i, j, k}, static_cast<int>(patch.points.size()));
    if (is_new) patch.points.push_back(Vector3d(coordinate(i), coordinate(j), coordinate(k)).normalized());
    return place->second;
  };
  for (int j = -n; j < n; j += 2) {
    for (int i = -n; i < n; i += 2) {
      patch.quads.push_back({point(i, j, n), point(i + 2, j, n), point(i + 2, j + 2, n), point(i, j + 2, n)});
    }
  }
  // The four sides, row by row downwards. Side s faces +x, +y, -x, -y; a runs along it, counter-clockwise.
  const auto side_point = [&](int s, int a, int k) {
    switch (s) {
      case 0:
        return point(n, a, k);
      case 1:
        return point(-a, n, k);
      case 2:
        return point(-n, -a, k);
      default:
        return point(a, -n, k);
    }
  };
  for (int k = n; k > -2 * below; k -= 2) {
    for (int s = 0; s < 4; ++s) {
      for (int a = -n; a < n; a += 2) {
        patch.quads.push_back(
            {side_point(s, a, k - 2), side_point(s, a + 2, k - 2), side_point(s, a + 2, k), side_point(s, a, k)});
      }
    }
  }
  return patch;
}

/// Square |x|, |y| <= half_width in the plane z = 0, n x n quads.
Patch square(int n, double half_width) {
  Patch patch;
  const auto coordinate = [&](int i) { return half_width * (2 * i - n) / n; };
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) patch.points.emplace_back(coordinate(i), coordinate(j), 0);
  }
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const int first = j * (n + 1) + i;
      patch.quads.push_back({first, first + 1, first + n + 2, first + n + 1});
    }
  }
  return patch;
}

/// nu x nv quads of point(u, v), u and v in [0, 1]; d/du x d/dv points outwards.
template <class Point>
Patch grid(int nu, int nv, const Point& point) {
  Patch patch;
  for (int j = 0; j <= nv; ++j) {
    for (int i = 0; i <= nu; ++i)
      patch.points.push_back(point(static_cast<double>(i) / nu, static_cast<double>(j) / nv));
  }
  for (int j = 0; j < nv; ++j) {
    for (int i = 0; i < nu; ++i) {
      const int first = j * (nu + 1) + i;
      patch.quads.push_back({first, first + 1, first + nu + 2, first + nu + 1});
    }
  }
  return patch;
}

std::vector<Vector3d> scaled(const std::vector<Vector3d>& points, double factor) {
  std::vector<Vector3d> result;
  for (const Vector3d& point : points) result.push_back(factor * point);
  return result;
}

/// Node numbers of the quads of a patch whose first point is node `first`.
std::vector<Quad> shifted(const std::vector<Quad>& quads, int first) {
  std::vector<Quad> result = quads;
  for (Quad& quad : result) {
    for (int& node : quad) node += first;
  }
  return result;
}

/// The same quads seen from the other side.
std::vector<Quad> reversed(const std::vector<Quad>& quads) {
  std::vector<Quad> result;
  for (const Quad& quad : quads) result.push_back({quad[0], quad[3], quad[2], quad[1]});
  return result;
}

// ---------------------------------------------------------------------------------------------------------------------
// Model files

std::string text(const Vector3d& v) {
  return fmt::format("{:.9g},{:.9g},{:.9g}", v.x() + 0.0, v.y() + 0.0, v.z() + 0.0);  // + 0.0: no "-0"
}

/// A FEBio 4.0 file in the making. Node and element numbers are 1-based.
struct Feb {
  std::string nodes, elements, surfaces, domains, sets;  // parts of the mesh
  std::string materials, rigid, discrete, steps, load_data;
  int node_count = 0, element_count = 0, material_count = 0, step_count = 0, controller_count = 0;

  int add_nodes(const std::string& name, const std::vector<Vector3d>& points) {
    const int first = node_count + 1;
    nodes += fmt::format("<Nodes name=\"{}\">\n", name);
    for (const Vector3d& point : points) nodes += fmt::format("<node id=\"{}\">{}</node>\n", ++node_count, text(point));
    nodes += "</Nodes>\n";
    return first;
  }

  void add_shells(const std::string& name, const std::string& material, const std::vector<Quad>& quads) {
    elements += fmt::format("<Elements type=\"quad4\" name=\"{}\">\n", name);
    for (const Quad& q : quads) {
      elements += fmt::format("<elem id=\"{}\">{},{},{},{}</elem>\n", ++element_count, q[0], q[1], q[2], q[3]);
    }
    elements += "</Elements>\n";
    domains += fmt::format("<ShellDomain name=\"{}\" mat=\"{}\"><shell_thickness>0</shell_thickness></ShellDomain>\n",
                           name, material);
  }

  /// Hexahedra between surfaces of equal mesh; sheets: the first node of each, from the inside outwards.
  void add_hexes(const std::string& name, const std::string& material, const std::vector<Quad>& quads,
                 const std::vector<int>& sheets) {
    elements += fmt::format("<Elements type=\"hex8\" name=\"{}\">\n", name);
    for (std::size_t layer = 0; layer + 1 < sheets.size(); ++layer) {
      const std::vector<Quad> inner = shifted(quads, sheets[layer]), outer = shifted(quads, sheets[layer + 1]);
      for (std::size_t i = 0; i < quads.size(); ++i) {
        elements += fmt::format("<elem id=\"{}\">{},{}</elem>\n", ++element_count, fmt::join(inner[i], ","),
                                fmt::join(outer[i], ","));
      }
    }
    elements += "</Elements>\n";
    domains += fmt::format("<SolidDomain name=\"{}\" mat=\"{}\"/>\n", name, material);
  }

  void add_surface(const std::string& name, const std::vector<Quad>& quads) {
    surfaces += fmt::format("<Surface name=\"{}\">\n", name);
    int id = 0;
    for (const Quad& q : quads) {
      surfaces += fmt::format("<quad4 id=\"{}\">{},{},{},{}</quad4>\n", ++id, q[0], q[1], q[2], q[3]);
    }
    surfaces += "</Surface>\n";
  }

  void add_cartilage(const std::string& name) {
    materials += fmt::format(
        "<material id=\"{}\" name=\"{}\" type=\"neo-Hookean\">\n<density>1</density>\n<E>11.85</E>\n"
        "<v>0.45</v>\n</material>\n",
        ++material_count, name);
  }

  void add_bone(const std::string& name, const Vector3d& center_of_mass) {
    materials += fmt::format(
        "<material id=\"{}\" name=\"{}\" type=\"rigid body\">\n<density>1</density>\n"
        "<center_of_mass>{}</center_of_mass>\n</material>\n",
        ++material_count, name, text(center_of_mass));
  }

  /// dofs: which of Rx, Ry, Rz, Ru, Rv, Rw are held, as six characters 0 or 1.
  static std::string fixed(const std::string& body, const std::string& dofs) {
    std::string result = fmt::format("<rigid_bc name=\"{0} held\" type=\"rigid_fixed\">\n<rb>{0}</rb>\n", body);
    const char* names = "xyzuvw";
    for (int i = 0; i < 6; ++i) result += fmt::format("<R{0}_dof>{1}</R{0}_dof>\n", names[i], dofs[i]);
    return result + "</rigid_bc>\n";
  }

  static std::string moved(const std::string& body, const std::string& dof, double value, int controller) {
    return fmt::format(
        "<rigid_bc name=\"{0} moved\" type=\"rigid_displacement\">\n<rb>{0}</rb>\n<dof>{1}</dof>\n"
        "<value lc=\"{3}\">{2:.9g}</value>\n<relative>0</relative>\n</rigid_bc>\n",
        body, dof, value, controller);
  }

  static std::string loaded(const std::string& body, const std::string& dof, double value, int controller) {
    return fmt::format(
        "<rigid_load name=\"load on {0}\" type=\"rigid_force\">\n<rb>{0}</rb>\n<dof>{1}</dof>\n"
        "<value lc=\"{3}\">{2:.9g}</value>\n<load_type>LOAD</load_type>\n<relative>0</relative>\n"
        "</rigid_load>\n",
        body, dof, value, controller);
  }

  /// A step of length 1 in `states` increments.
  void add_step(const std::string& name, const std::string& rigid_conditions, int states = 2) {
    steps += fmt::format(
        "<step id=\"{0}\" name=\"{1}\">\n<Control>\n<analysis>STATIC</analysis>\n<time_steps>{3}</time_steps>\n"
        "<step_size>{4:g}</step_size>\n<time_stepper type=\"default\">\n<max_retries>10</max_retries>\n"
        "<opt_iter>12</opt_iter>\n<dtmin>0.0001</dtmin>\n<dtmax>{4:g}</dtmax>\n</time_stepper>\n"
        "<solver type=\"solid\">\n<symmetric_stiffness>non-symmetric</symmetric_stiffness>\n<max_refs>30</max_refs>\n"
        "<dtol>0.001</dtol>\n<etol>0.01</etol>\n<rtol>0</rtol>\n<lstol>0.9</lstol>\n<lsmin>0.01</lsmin>\n"
        "<lsiter>5</lsiter>\n<qn_method type=\"BFGS\">\n<max_ups>0</max_ups>\n</qn_method>\n</solver>\n</Control>\n"
        "<Rigid>\n{2}</Rigid>\n</step>\n",
        ++step_count, name, rigid_conditions, states, 1.0 / states);
  }

  /// Linear load curve through the points "t,value".
  int add_controller(const std::string& name, const std::vector<std::string>& points) {
    load_data += fmt::format(
        "<load_controller id=\"{}\" name=\"{}\" type=\"loadcurve\">\n<interpolate>LINEAR</interpolate>\n"
        "<extend>CONSTANT</extend>\n<points>\n",
        ++controller_count, name);
    for (const std::string& point : points) load_data += fmt::format("<pt>{}</pt>\n", point);
    load_data += "</points>\n</load_controller>\n";
    return controller_count;
  }

  /// Two surfaces that slide on each other.
  struct Pair {
    std::string name, primary, secondary;
  };

  std::string file(const std::string& comment, const std::string& primary, const std::string& secondary) const {
    return file(comment, {{"joint", primary, secondary}});
  }

  std::string file(const std::string& comment, const std::vector<Pair>& pairs) const {
    std::string all = "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>\n";
    all += fmt::format("<!-- {} Made by samples/generate.cpp. -->\n", comment);
    all += "<febio_spec version=\"4.0\">\n<Module type=\"solid\">\n<units>mm-N-s</units>\n</Module>\n";
    all += "<Globals>\n<Constants>\n<T>0</T>\n<R>0</R>\n<Fc>0</Fc>\n</Constants>\n</Globals>\n";
    all += "<Material>\n" + materials + "</Material>\n";
    all += "<Mesh>\n" + nodes + elements + surfaces;
    for (const Pair& pair : pairs)
      all +=
          fmt::format("<SurfacePair name=\"{}\">\n<primary>{}</primary>\n<secondary>{}</secondary>\n</SurfacePair>\n",
                      pair.name, pair.primary, pair.secondary);
    all += sets + "</Mesh>\n<MeshDomains>\n" + domains + "</MeshDomains>\n";
    all += "<Rigid>\n" + rigid + "</Rigid>\n<Contact>\n";
    for (const Pair& pair : pairs)
      all += fmt::format(
          "<contact name=\"{0}\" type=\"sliding-elastic\" "
          "surface_pair=\"{0}\">\n<laugon>PENALTY</laugon>\n"
          "<penalty>20</penalty>\n<auto_penalty>1</auto_penalty>\n<two_pass>0</two_pass>\n"
          "<symmetric_stiffness>0</symmetric_stiffness>\n<search_radius>1</search_radius>\n"
          "<search_tol>0.01</search_tol>\n<fric_coeff>0</fric_coeff>\n</contact>\n",
          pair.name);
    all += "</Contact>\n";
    if (!discrete.empty()) all += "<Discrete>\n" + discrete + "</Discrete>\n";
    all += "<Step>\n" + steps + "</Step>\n<LoadData>\n" + load_data + "</LoadData>\n";
    all += "<Output>\n<plotfile type=\"febio\">\n";
    for (const char* variable : {"displacement", "contact pressure", "contact gap", "contact force", "contact area",
                                 "rigid force", "rigid position"}) {
      all += fmt::format("<var type=\"{}\"/>\n", variable);
    }
    return all + "</plotfile>\n</Output>\n</febio_spec>\n";
  }
};

// ---------------------------------------------------------------------------------------------------------------------
// The samples

constexpr double kBall = 20, kInterface = 22, kSocket = 24;  // [mm]
constexpr double kLoad = 2000;                               // [N]

/// Rows of quads by which the ball goes on below the rim: 20 degrees, so that no ray from the rim misses it.
int rows_below(int n) { return static_cast<int>(std::lround(n * 20.0 / 90.0)); }

void hold_and_load_ball(Feb& feb) {
  feb.rigid = Feb::fixed("socket", "111111") + Feb::fixed("ball", "000111");
  const int ramp = feb.add_controller("ramp", {"0,0", "1,1"});
  feb.add_step("load", Feb::loaded("ball", "Rz", kLoad, ramp));
}

/// Ball of radius 20 in a hemispherical socket of radius 24 that is lined with 4 mm of cartilage.
/// twist: angle by which the ball's mesh is turned about the pole [rad]; 0: its facets coincide with the layer's.
std::string one_layer_spheres(int n, double twist) {
  Feb feb;
  feb.add_cartilage("cartilage");
  feb.add_bone("socket", Vector3d::Zero());
  feb.add_bone("ball", Vector3d::Zero());
  const Patch lining = hemisphere(n, 0);
  Patch ball = hemisphere(n, rows_below(n));
  if (twist != 0) {
    for (Vector3d& point : ball.points) point = Eigen::AngleAxisd(twist, Vector3d::UnitZ()) * point;
  }
  std::vector<int> sheets;
  for (const double radius : {kBall, kInterface, kSocket}) {
    sheets.push_back(feb.add_nodes(fmt::format("cartilage_r{}", radius), scaled(lining.points, radius)));
  }
  const int ball_node = feb.add_nodes("ball_nodes", scaled(ball.points, kBall));
  feb.add_hexes("cartilage_layer", "cartilage", lining.quads, sheets);
  feb.add_shells("socket_bone", "socket", reversed(shifted(lining.quads, sheets.back())));
  feb.add_shells("ball_bone", "ball", shifted(ball.quads, ball_node));
  feb.add_surface("socket_articular", reversed(shifted(lining.quads, sheets.front())));
  feb.add_surface("ball_articular", shifted(ball.quads, ball_node));
  hold_and_load_ball(feb);
  return feb.file("Concentric spheres, one 4 mm layer on the socket.", "socket_articular", "ball_articular");
}

std::string matched_spheres(int n) { return one_layer_spheres(n, 0); }
std::string twisted_spheres(int n) { return one_layer_spheres(n, 17 * kPi / 180); }

/// Ball of radius 20 and socket of radius 24, each lined with 2 mm; the layers meet at radius 22.
std::string two_layer_spheres(int n) {
  Feb feb;
  feb.add_cartilage("socket cartilage");
  feb.add_cartilage("ball cartilage");
  feb.add_bone("socket", Vector3d::Zero());
  feb.add_bone("ball", Vector3d::Zero());
  const Patch lining = hemisphere(n, 0), ball = hemisphere(n, rows_below(n));
  std::vector<int> socket_sheets, ball_sheets;
  for (const double radius : {kInterface, kSocket}) {
    socket_sheets.push_back(feb.add_nodes(fmt::format("socket_r{}", radius), scaled(lining.points, radius)));
  }
  for (const double radius : {kBall, kInterface}) {
    ball_sheets.push_back(feb.add_nodes(fmt::format("ball_r{}", radius), scaled(ball.points, radius)));
  }
  feb.add_hexes("socket_layer", "socket cartilage", lining.quads, socket_sheets);
  feb.add_hexes("ball_layer", "ball cartilage", ball.quads, ball_sheets);
  feb.add_shells("socket_bone", "socket", reversed(shifted(lining.quads, socket_sheets.back())));
  feb.add_shells("ball_bone", "ball", shifted(ball.quads, ball_sheets.front()));
  feb.add_surface("socket_articular", reversed(shifted(lining.quads, socket_sheets.front())));
  feb.add_surface("ball_articular", shifted(ball.quads, ball_sheets.back()));
  hold_and_load_ball(feb);
  return feb.file("Concentric spheres, two 2 mm layers.", "socket_articular", "ball_articular");
}

constexpr double kIndenter = 25, kThickness = 2;  // [mm]
constexpr double kHalfWidth = 5.6;                // [mm], outside every contact circle of these samples

/// A spherical indenter above a flat layer, touching it at the origin. The layer's nodes lie at z = 0, -1 and -2, the
/// indenter's straight above them.
struct FlatMesh {
  int bone_node = 0;  ///< first node of the sheet at z = -2
};
FlatMesh add_sphere_on_flat(Feb& feb, int n, const std::string& sphere, const std::string& base) {
  const Patch flat = square(n, kHalfWidth);
  FlatMesh mesh;
  std::vector<int> sheets;
  for (const double depth : {kThickness, kThickness / 2, 0.0}) {
    std::vector<Vector3d> points = flat.points;
    for (Vector3d& point : points) point.z() = -depth;
    sheets.push_back(feb.add_nodes(fmt::format("cartilage_z{}", depth), points));
  }
  mesh.bone_node = sheets.front();
  std::vector<Vector3d> cap = flat.points;
  for (Vector3d& p : cap) p.z() = p.squaredNorm() / (kIndenter + std::sqrt(kIndenter * kIndenter - p.squaredNorm()));
  const int cap_node = feb.add_nodes(sphere + "_nodes", cap);
  feb.add_hexes("cartilage_layer", "cartilage", flat.quads, sheets);
  feb.add_shells(base + "_bone", base, shifted(flat.quads, sheets.front()));
  feb.add_shells(sphere + "_bone", sphere, reversed(shifted(flat.quads, cap_node)));
  feb.add_surface(base + "_articular", shifted(flat.quads, sheets.back()));
  feb.add_surface(sphere + "_articular", reversed(shifted(flat.quads, cap_node)));
  return mesh;
}

/// Rigid sphere pressed into a flat layer: 0.4 mm deep at t = 1, then by 400 N at t = 2.
std::string sphere_on_flat(int n) {
  Feb feb;
  feb.add_cartilage("cartilage");
  feb.add_bone("base", Vector3d::Zero());
  feb.add_bone("sphere", {0, 0, kIndenter});
  add_sphere_on_flat(feb, n, "sphere", "base");
  feb.rigid = Feb::fixed("base", "111111") + Feb::fixed("sphere", "110111");
  const int depth = feb.add_controller("depth", {"0,0", "1,1"});
  const int force = feb.add_controller("force", {"1,0.7", "2,1"});
  feb.add_step("by depth", Feb::moved("sphere", "z", -0.4, depth));
  feb.add_step("by force", Feb::loaded("sphere", "Rz", -400, force));
  return feb.file("Rigid sphere of radius 25 on a flat layer of 2 mm.", "base_articular", "sphere_articular");
}

constexpr double kApart = 22;  // [mm], of each condyle from the middle

/// A tibia whose two flat plateaus are one surface, under a femur with two spherical condyles. The femur may sink and
/// tilt (Rv); 500 N act 4 mm medially of the middle (x lateral), at the height of the condyles' centres.
std::string plateaus(int n) {
  Feb feb;
  feb.add_cartilage("cartilage");
  feb.add_bone("tibia", Vector3d::Zero());
  feb.add_bone("femur", {-4, 0, kIndenter});
  const Patch flat = square(n, kHalfWidth);
  std::vector<Quad> tibia_surface, femur_surface;
  for (const double x : {-kApart, kApart}) {
    const std::string side = x < 0 ? "medial" : "lateral";
    std::vector<int> sheets;
    for (const double depth : {kThickness, kThickness / 2, 0.0}) {
      std::vector<Vector3d> points = flat.points;
      for (Vector3d& point : points) point += Vector3d(x, 0, -depth);
      sheets.push_back(feb.add_nodes(fmt::format("{}_z{}", side, depth), points));
    }
    std::vector<Vector3d> cap = flat.points;
    for (Vector3d& p : cap) {
      p.z() = p.squaredNorm() / (kIndenter + std::sqrt(kIndenter * kIndenter - p.squaredNorm()));
      p.x() += x;
    }
    const int cap_node = feb.add_nodes(side + "_condyle_nodes", cap);
    feb.add_hexes(side + "_plateau", "cartilage", flat.quads, sheets);
    feb.add_shells(side + "_bone", "tibia", shifted(flat.quads, sheets.front()));
    feb.add_shells(side + "_condyle", "femur", reversed(shifted(flat.quads, cap_node)));
    for (const Quad& q : shifted(flat.quads, sheets.back())) tibia_surface.push_back(q);
    for (const Quad& q : reversed(shifted(flat.quads, cap_node))) femur_surface.push_back(q);
  }
  feb.add_surface("tibia_articular", tibia_surface);
  feb.add_surface("femur_articular", femur_surface);
  feb.rigid = Feb::fixed("tibia", "111111") + Feb::fixed("femur", "110101");
  const int ramp = feb.add_controller("ramp", {"0,0", "1,1"});
  feb.add_step("load", Feb::loaded("femur", "Rz", -500, ramp));
  return feb.file("Two spherical condyles on the two plateaus of a tibia, one contact.", "tibia_articular",
                  "femur_articular");
}

/// A spherical condyle on a flat plateau, pressed by 300 N and tied by two stretched ligaments, one tether that
/// gets taut and one that gets slack. Free but for flexion (Ru).
std::string ligament(int n) {
  Feb feb;
  feb.add_cartilage("cartilage");
  feb.add_bone("tibia", Vector3d::Zero());
  feb.add_bone("femur", {0, 0, kIndenter});
  const FlatMesh mesh = add_sphere_on_flat(feb, n, "femur", "tibia");
  const int plateau_center = mesh.bone_node + (n + 1) * (n / 2) + n / 2;
  // Tethers run between nodes, so each bone has a small plate with a node on the z axis.
  const auto plate = [&](const std::string& bone, double z) {
    const int first = feb.add_nodes(bone + "_plate_nodes", {{0, 0, z}, {2, 0, z}, {2, 2, z}, {0, 2, z}});
    feb.add_shells(bone + "_plate", bone, {{first, first + 1, first + 2, first + 3}});
    return first;
  };
  const int femur_node = plate("femur", kIndenter), frame_node = plate("tibia", 60);
  feb.sets =
      fmt::format("<DiscreteSet name=\"tethers\">\n<delem>{0},{1}</delem>\n<delem>{0},{2}</delem>\n</DiscreteSet>\n",
                  femur_node, frame_node, plateau_center);
  feb.discrete =
      "<discrete_material id=\"1\" name=\"tether\" type=\"tension-only linear spring\">\n<E>40</E>\n"
      "</discrete_material>\n<discrete dmat=\"1\" discrete_set=\"tethers\"/>\n";
  feb.rigid = Feb::fixed("tibia", "111111") + Feb::fixed("femur", "000100");
  for (const int side : {1, -1}) {
    feb.rigid += fmt::format(
        "<rigid_connector name=\"{}\" type=\"rigid "
        "spring\">\n<body_a>femur</body_a>\n<body_b>tibia</body_b>\n<k>50</k>\n"
        "<insertion_a>{},0,25</insertion_a>\n<insertion_b>{},0,-20</insertion_b>\n<free_length>44</free_length>\n"
        "</rigid_connector>\n",
        side > 0 ? "medial ligament" : "lateral ligament", 30 * side, 24 * side);
  }
  const int ramp = feb.add_controller("ramp", {"0,0", "1,1"});
  feb.add_step("load", Feb::loaded("femur", "Rz", -300, ramp));
  return feb.file("Spherical condyle on a flat plateau, with ligaments.", "tibia_articular", "femur_articular");
}

/// A bone with attachments: each a small rigid quad whose first node is the site.
std::vector<int> add_sites(Feb& feb, const std::string& bone, const std::vector<Vector3d>& sites) {
  std::vector<int> nodes;
  std::vector<Quad> quads;
  std::vector<Vector3d> points;
  for (const Vector3d& p : sites)
    for (const Vector3d& d : {Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(1, 1, 0), Vector3d(0, 1, 0)})
      points.push_back(p + d);
  const int first = feb.add_nodes(bone + "_sites", points);
  for (int i = 0; i < static_cast<int>(sites.size()); ++i) {
    nodes.push_back(first + 4 * i);
    quads.push_back({first + 4 * i, first + 4 * i + 1, first + 4 * i + 2, first + 4 * i + 3});
  }
  feb.add_shells(bone + "_attachments", bone, quads);
  return nodes;
}

/// A layer of cartilage on a bone, between two grids of equal mesh, and its articular surface. `outside`: the articular
/// grid lies on the side that the grids' normals point to.
void add_layer(Feb& feb, const std::string& name, const std::string& bone, const Patch& bone_side,
               const Patch& articular, bool outside) {
  const int first = feb.add_nodes(name + "_bone_nodes", bone_side.points);
  const int second = feb.add_nodes(name + "_nodes", articular.points);
  const std::vector<int> sheets = outside ? std::vector<int>{first, second} : std::vector<int>{second, first};
  feb.add_hexes(name + "_cartilage", "cartilage", articular.quads, sheets);
  const auto facing = [&](const std::vector<Quad>& quads) { return outside ? quads : reversed(quads); };
  feb.add_shells(name + "_bone", bone, facing(shifted(articular.quads, first)));
  feb.add_surface(name, facing(shifted(articular.quads, second)));
}

/// A spring of the given material between two nodes, in the order of the material's number.
void add_bundle(Feb& feb, const std::string& name, int material, const std::vector<std::array<int, 2>>& pairs) {
  feb.sets += fmt::format("<DiscreteSet name=\"{}\">\n", name);
  for (const auto& pair : pairs) feb.sets += fmt::format("<delem>{},{}</delem>\n", pair[0], pair[1]);
  feb.sets += "</DiscreteSet>\n";
  feb.discrete += fmt::format("<discrete dmat=\"{}\" discrete_set=\"{}\"/>\n", material, name);
}

/// Femur, tibia and patella of a right knee, x lateral, y forwards, z upwards, the flexion axis along x through the
/// origin. Spherical condyles on dished plateaus, a patella with two facets in a groove, ligaments as bundles that only
/// pull, the quadriceps as two springs that are stretched from the start. The femur is flexed by 60 degrees about the
/// axis; tibia (all but flexion) and patella (all six) find their places. Radii of condyles and groove are those of a
/// surface of revolution about the axis, so flexion alone changes no gap.
std::string knee(int n) {
  Feb feb;
  feb.add_cartilage("cartilage");
  feb.add_bone("femur", Vector3d::Zero());
  feb.add_bone("tibia", {0, 0, -60});
  feb.add_bone("patella", {0, 34, 3});
  const double degree = kPi / 180;
  const auto round = [](double r, double x, double angle) {  // distance r from the flexion axis; 0: downwards
    return Vector3d(x, r * std::sin(angle), -r * std::cos(angle));
  };
  for (const int side : {-1, 1}) {
    const std::string which = side < 0 ? "medial" : "lateral";
    const double center = 22.0 * side;
    // a bone's patch reaches a little farther than its cartilage, so that every normal meets it
    const auto condyle = [&](double radius, double wider) {
      return grid(2 * n, n, [&, radius, wider](double u, double v) {
        const double angle = (-25 + wider * (130 * u - 65)) * degree, across = wider * (70 * v - 35) * degree;
        return Vector3d(round(radius * std::cos(across), center + radius * std::sin(across), angle));
      });
    };
    add_layer(feb, which + "_condyle", "femur", condyle(20, 1.02), condyle(22, 1), true);
    const double dish = side < 0 ? 32 : 45;  // [mm], radius
    const auto plateau = [&](double depth) {
      return grid(n, n, [&, depth](double u, double v) {
        const double wider = depth > 0 ? 1.15 : 1, x = wider * (26 * u - 13), y = wider * (28 * v - 14);
        return Vector3d(center + x, y, -22 - depth + dish - std::sqrt(dish * dish - x * x - y * y));
      });
    };
    add_layer(feb, which + "_plateau", "tibia", plateau(2.5), plateau(0), true);
    // the groove's profile: two slopes of 31 degrees, rounded at the bottom
    const auto profile = [](double x) { return std::sqrt(0.36 * x * x + 9) - 3; };
    const auto trochlea = [&](double less) {
      return grid(2 * n, n / 2, [&, less](double u, double v) {
        const double more = less > 0 ? 1.6 : 0, w = (16.7 + 2 * more) * v - more, x = side < 0 ? -17 + w : 0.3 + w;
        const double angle = 75 + (less > 0 ? 1.02 : 1) * (130 * u - 65);
        return Vector3d(round(24 + profile(x) - less, x, angle * degree));
      });
    };
    add_layer(feb, which + "_trochlea", "femur", trochlea(2.5), trochlea(0), true);
    // along the groove the patella is flatter than it: radius 40 about (y, z) = (-16, 0), then 5 degrees upwards
    const auto facet = [&](double more) {
      return grid(n, n / 2, [&, more](double u, double v) {
        const double wide = more > 0 ? 1.9 : 0, w = (11 + 2 * wide) * v - wide, x = side < 0 ? -13 + w : 2 + w;
        const double angle = 90 + (more > 0 ? 1.02 : 1) * (40 * u - 20);
        const Vector3d p = round(40 + profile(x) + more, x, angle * degree) - Vector3d(0, 16, 0);
        return Vector3d(Eigen::AngleAxisd(5 * degree, Vector3d::UnitX()) * p);
      });
    };
    add_layer(feb, which + "_facet", "patella", facet(3), facet(0), false);
  }
  const std::vector<int> femur = add_sites(feb, "femur", {{5, -7, 3}, {6, -5, 5}, {-6, 2, 0}, {-5, 4, 2}});
  const std::vector<int> tibia =
      add_sites(feb, "tibia", {{-2, 12, -25}, {0, 9, -25}, {-1, -20, -29}, {1, -21, -30}, {-5, 32, -58}, {5, 32, -58}});
  const std::vector<int> patella = add_sites(feb, "patella", {{-6, 36, -17}, {6, 36, -17}});
  const auto material = [&](int id, const char* name, double stiffness) {
    feb.discrete += fmt::format(
        "<discrete_material id=\"{}\" name=\"{}\" type=\"tension-only linear spring\">\n<E>{:g}</E>\n"
        "</discrete_material>\n",
        id, name, stiffness);
  };
  material(1, "cruciate fibres", 80);
  material(2, "patellar tendon fibres", 400);
  add_bundle(feb, "ACL", 1, {{femur[0], tibia[0]}, {femur[1], tibia[1]}});
  add_bundle(feb, "PCL", 1, {{femur[2], tibia[2]}, {femur[3], tibia[3]}});
  add_bundle(feb, "patellar tendon", 2, {{patella[0], tibia[4]}, {patella[1], tibia[5]}});
  feb.rigid = Feb::fixed("femur", "111011") + Feb::fixed("tibia", "000100");
  const auto stretched = [&](const char* name, const char* a, const char* b, double stiffness, double free_length,
                             const Vector3d& from, const Vector3d& to) {
    feb.rigid += fmt::format(
        "<rigid_connector name=\"{}\" type=\"rigid spring\">\n<body_a>{}</body_a>\n<body_b>{}</body_b>\n<k>{:g}</k>\n"
        "<insertion_a>{}</insertion_a>\n<insertion_b>{}</insertion_b>\n<free_length>{:g}</free_length>\n"
        "</rigid_connector>\n",
        name, a, b, stiffness, text(from), text(to), free_length);
  };
  stretched("vastus medialis", "patella", "femur", 4, 120, {-7, 38, 20}, {-12, 30, 200});
  stretched("vastus lateralis", "patella", "femur", 4, 120, {7, 38, 20}, {12, 30, 200});
  stretched("MCL anterior", "femur", "tibia", 50, 61.5, {-38, 0, 1}, {-33, 6, -62});
  stretched("MCL posterior", "femur", "tibia", 50, 57.5, {-38, -2, 0}, {-33, -3, -60});
  stretched("LCL", "femur", "tibia", 60, 46, {38, 0, 1}, {37, -14, -45});
  const int ramp = feb.add_controller("flexion", {"0,0", "1,1"});
  const int load = feb.add_controller("load", {"0,1", "1,1"});
  feb.add_step("flexion",
               fmt::format("<rigid_bc name=\"flexion\" type=\"rigid_rotation\">\n<rb>femur</rb>\n<dof>Ru</dof>\n"
                           "<value lc=\"{}\">{:.9g}</value>\n<relative>0</relative>\n</rigid_bc>\n",
                           ramp, 60 * degree) +
                   Feb::loaded("tibia", "Rz", 300, load) + Feb::loaded("tibia", "Ry", 60, load) +
                   fmt::format("<rigid_load name=\"abduction\" type=\"rigid_moment\">\n<rb>tibia</rb>\n<dof>Rv</dof>\n"
                               "<value lc=\"{}\">8000</value>\n<relative>0</relative>\n</rigid_load>\n",
                               load),
               10);
  std::vector<Feb::Pair> pairs;
  for (const std::string which : {"medial", "lateral"})
    pairs.push_back({which + " tibiofemoral", which + "_plateau", which + "_condyle"});
  for (const std::string which : {"medial", "lateral"})
    pairs.push_back({which + " patellofemoral", which + "_facet", which + "_trochlea"});
  return feb.file("Synthetic knee: three bodies, four contacts.", pairs);
}

/// A meniscus around x = center: a ring with a wedge for its section, flat below, above on the sphere of `radius` that
/// touches z = 0; open for 60 degrees about the direction `opening`. The first two nodes of an element lie along the
/// ring, as its fibres do. `name`: of its material and elements; its surfaces are `name`_top and `name`_bottom. Answers
/// the nodes of its two ends, halfway up.
std::array<std::vector<int>, 2> add_meniscus(Feb& feb, const std::string& name, double center, double opening,
                                             double radius, int n) {
  constexpr double kInner = 6, kOuter = 14;  // [mm]
  const int around = 3 * n / 2, across = std::max(2, n / 4), up = std::max(2, n / 8);
  feb.materials += fmt::format(
      "<material id=\"{}\" name=\"{}\" type=\"trans iso Mooney-Rivlin\">\n<density>1</density>\n<c1>3.85</c1>\n"
      "<c2>0</c2>\n<c3>120</c3>\n<c4>1</c4>\n<c5>130</c5>\n<lam_max>1.1</lam_max>\n<k>16.7</k>\n"
      "<fiber type=\"local\">1,2</fiber>\n</material>\n",
      ++feb.material_count, name);
  std::array<std::vector<int>, 2> ends;
  std::vector<int> sheets;
  std::vector<Quad> quads;
  for (int k = 0; k <= up; ++k) {
    const Patch sheet = grid(around, across, [&](double u, double v) {
      const double angle = opening + kPi / 180 * (330 - 300 * u), r = kInner + (kOuter - kInner) * v;
      return Vector3d(center + r * std::cos(angle), r * std::sin(angle),
                      (radius - std::sqrt(radius * radius - r * r)) * k / up);
    });
    quads = sheet.quads;
    sheets.push_back(feb.add_nodes(fmt::format("{}_sheet_{}", name, k), sheet.points));
    for (int j = 0; j <= across; ++j) {
      if (k != up / 2) continue;
      ends[0].push_back(sheets.back() + j * (around + 1));
      ends[1].push_back(sheets.back() + j * (around + 1) + around);
    }
  }
  feb.add_hexes(name, name, quads, sheets);
  feb.add_surface(name + "_top", shifted(quads, sheets.back()));
  feb.add_surface(name + "_bottom", reversed(shifted(quads, sheets.front())));
  return ends;
}

/// Two condyles with cartilage on the flat cartilage of a tibia, and on each side a meniscus that has fibres along its
/// ring and is held by the springs of its horns alone. 500 N press the femur down, 4 mm medially of the middle and at
/// the height of the condyles' centres; it may sink and tilt about y.
std::string menisci(int n) {
  constexpr double kRadius = 22, kCartilage = 2, kSide = 20, kHalf = 15;  // [mm]
  Feb feb;
  feb.add_cartilage("cartilage");
  feb.add_bone("tibia", Vector3d::Zero());
  feb.add_bone("femur", {-4, 0, kRadius});
  feb.discrete =
      "<discrete_material id=\"1\" name=\"horn fibres\" type=\"linear spring\">\n<E>45</E>\n</discrete_material>\n";
  std::vector<Feb::Pair> pairs;
  std::vector<Vector3d> sites;
  std::vector<std::vector<int>> horns;
  for (const int side : {-1, 1}) {
    const std::string which = side < 0 ? "medial" : "lateral", meniscus = which + "_meniscus";
    const double center = kSide * side, opening = side < 0 ? 0 : kPi;  // towards the middle
    const auto plateau = [&](double depth) {
      return grid(n, n, [&, depth](double u, double v) {
        const double half = (depth > 0 ? 1.02 : 1) * kHalf;
        return Vector3d(center + half * (2 * u - 1), half * (2 * v - 1), -depth);
      });
    };
    add_layer(feb, which + "_plateau", "tibia", plateau(kCartilage), plateau(0), true);
    const auto condyle = [&](double radius) {
      return grid(n, n, [&, radius](double u, double v) {
        const double half = (radius < kRadius ? 1.02 : 1) * kHalf / kRadius;
        const Vector3d down(std::tan(half * (2 * u - 1)), std::tan(half * (2 * v - 1)), -1);
        return Vector3d(Vector3d(center, 0, kRadius) + radius * down.normalized());
      });
    };
    add_layer(feb, which + "_condyle", "femur", condyle(kRadius - kCartilage), condyle(kRadius), false);
    const std::array<std::vector<int>, 2> ends = add_meniscus(feb, meniscus, center, opening, kRadius + 1, n);
    for (const int end : {-1, 1}) {  // the ring goes on straight for 8 mm
      const double angle = opening + end * kPi / 6;
      sites.push_back(Vector3d(center + 10 * std::cos(angle) + 8 * end * std::sin(angle),
                               10 * std::sin(angle) - 8 * end * std::cos(angle), -1));
      horns.push_back(end < 0 ? ends[0] : ends[1]);
    }
    pairs.push_back({which + " tibiofemoral", which + "_plateau", which + "_condyle"});
    pairs.push_back({which + " femoromeniscal", meniscus + "_top", which + "_condyle"});
    pairs.push_back({which + " meniscotibial", meniscus + "_bottom", which + "_plateau"});
  }
  const std::vector<int> tibia = add_sites(feb, "tibia", sites);
  const std::array<const char*, 4> names = {"medial posterior horn", "medial anterior horn", "lateral anterior horn",
                                            "lateral posterior horn"};
  for (std::size_t h = 0; h < names.size(); ++h) {
    std::vector<std::array<int, 2>> fibres;
    for (const int node : horns[h]) fibres.push_back({node, tibia[h]});
    add_bundle(feb, names[h], 1, fibres);
  }
  feb.rigid = Feb::fixed("tibia", "111111") + Feb::fixed("femur", "110101");
  const int ramp = feb.add_controller("ramp", {"0,0", "1,1"});
  feb.add_step("load", Feb::loaded("femur", "Rz", -500, ramp));
  return feb.file("Two condyles, two menisci, the plateaus of a tibia.", pairs);
}

/// Ten bones in a row along z, each with a ball at its lower end (radius 10) that stands in the dish (radius 12) of the
/// one below, and four stretched ligaments across each joint. The lowest is held; the highest may not move sideways and
/// carries 60 N, the sixth is pushed sideways by 5 N.
std::string chain(int n) {
  Feb feb;
  feb.add_cartilage("cartilage");
  constexpr int kBones = 10;
  constexpr double kSpacing = 20, kLower = 10, kUpper = 12, kHalf = 6;  // [mm]
  std::vector<Feb::Pair> pairs;
  for (int b = 0; b < kBones; ++b) feb.add_bone(fmt::format("bone {}", b + 1), {0, 0, kSpacing * b});
  for (int b = 0; b < kBones; ++b) {
    const std::string bone = fmt::format("bone {}", b + 1);
    // surfaces of radius r that meet the axis at z: both bulge downwards
    const auto cap = [&](double radius, double z, double half) {
      return grid(n, n, [radius, z, half](double u, double v) {
        const double x = half * (2 * u - 1), y = half * (2 * v - 1);
        return Vector3d(x, y, z + radius - std::sqrt(radius * radius - x * x - y * y));
      });
    };
    const double middle = kSpacing * b;
    if (b > 0)
      add_layer(feb, fmt::format("ball_{}", b + 1), bone, cap(kLower - 1.5, middle - 8.5, 0.89 * kHalf),
                cap(kLower, middle - 10, kHalf), false);
    if (b + 1 < kBones) {
      add_layer(feb, fmt::format("dish_{}", b + 1), bone, cap(kUpper + 1.5, middle + 8.5, 1.16 * kHalf),
                cap(kUpper, middle + 10, kHalf), true);
      pairs.push_back(
          {fmt::format("joint {}-{}", b + 1, b + 2), fmt::format("dish_{}", b + 1), fmt::format("ball_{}", b + 2)});
    }
  }
  feb.rigid = Feb::fixed("bone 1", "111111") + Feb::fixed("bone 10", "110000");
  for (int b = 0; b + 1 < kBones; ++b) {
    for (int k = 0; k < 4; ++k) {
      const double x = k == 0 ? 10 : k == 1 ? -10 : 0, y = k == 2 ? 10 : k == 3 ? -10 : 0;
      feb.rigid += fmt::format(
          "<rigid_connector name=\"ligament {0}-{1} {2}\" type=\"rigid spring\">\n<body_a>bone {0}</body_a>\n"
          "<body_b>bone {1}</body_b>\n<k>150</k>\n<insertion_a>{3:g},{4:g},{5:g}</insertion_a>\n"
          "<insertion_b>{3:g},{4:g},{6:g}</insertion_b>\n<free_length>9</free_length>\n</rigid_connector>\n",
          b + 1, b + 2, k + 1, x, y, kSpacing * b + 5, kSpacing * (b + 1) - 5);
    }
  }
  const int ramp = feb.add_controller("ramp", {"0,0", "1,1"});
  feb.add_step("load", Feb::loaded("bone 10", "Rz", -60, ramp) + Feb::loaded("bone 6", "Rx", 5, ramp));
  return feb.file("Ten bones in a row, nine contacts.", pairs);
}

/// A made-up cycle of walking for the hip of 800 N, n + 1 instants: the force on the femur has the shape that is
/// published for walking, two peaks of 2.4 and 2.1 body weights at 16 and 46 % of the cycle, a valley between them and
/// a third to six tenths of a body weight in swing; its direction swings by 18 degrees during stance, and back.
std::string gait(int n) {
  constexpr double kWeight = 800, kDegree = 3.14159265358979323846 / 180;
  std::string text = "cycle [%],fx [N],fy [N],fz [N]\n";
  for (int i = 0; i <= n; ++i) {
    const double s = static_cast<double>(i) / n;
    const auto hump = [&](double height, double at, double width) {
      return height * std::exp(-std::pow((s - at) / width, 2));
    };
    const double fz =
        kWeight * (0.3 + hump(2.0, 0.16, 0.07) + hump(0.6, 0.31, 0.12) + hump(1.7, 0.46, 0.09) + hump(0.3, 0.88, 0.07));
    const double angle = kDegree * (-12 + 18 * (s < 0.6 ? s / 0.6 : (1 - s) / 0.4));
    text += fmt::format("{:.1f},{:.1f},{:.1f},{:.1f}\n", 100 * s, 0.235 * fz, std::tan(angle) * fz, fz);
  }
  return text;
}

// ---------------------------------------------------------------------------------------------------------------------

void write(const std::string& path, const std::string& bytes) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  bool ok = file != nullptr && std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
  ok = file != nullptr && std::fclose(file) == 0 && ok;
  if (!ok) throw std::runtime_error(path + ": cannot be written");
}

struct Sample {
  const char* option;
  const char* path;  ///< of the committed file; nullptr: made on demand only
  int n;             ///< of the committed file
  std::string (*make)(int n);
};
constexpr Sample kSamples[] = {
    {"--spheres", "spheres/one_layer.feb", 28, matched_spheres},
    {"--twisted-spheres", nullptr, 0, twisted_spheres},
    {"--two-layer-spheres", "spheres/two_layers.feb", 28, two_layer_spheres},
    {"--sphere-on-flat", "sphere_on_flat/sphere_on_flat.feb", 56, sphere_on_flat},
    {"--plateaus", "plateaus/plateaus.feb", 24, plateaus},
    {"--ligament", "ligament/ligament.feb", 48, ligament},
    {"--knee", "knee/knee.feb", 16, knee},
    {"--menisci", "menisci/menisci.feb", 12, menisci},
    {"--chain", "chain/chain.feb", 12, chain},
    {"--gait", "osteotomy/gait.csv", 12, gait},
};

int run(const std::vector<std::string>& arguments) {
  if (arguments.size() == 1 && arguments[0].rfind("--", 0) != 0) {
    for (const Sample& sample : kSamples) {
      if (sample.path != nullptr) write(arguments[0] + "/" + sample.path, sample.make(sample.n));
    }
    return 0;
  }
  for (const Sample& sample : kSamples) {
    if (arguments.size() != 3 || arguments[0] != sample.option) continue;
    const int n = std::atoi(arguments[1].c_str());
    if (n < 2 || n % 2 != 0) throw std::runtime_error("N = " + arguments[1] + ", need an even number of at least 2");
    write(arguments[2], sample.make(n));
    return 0;
  }
  throw std::runtime_error(
      "usage: make_samples SAMPLES_DIR, or make_samples --spheres|--twisted-spheres|"
      "--two-layer-spheres|--sphere-on-flat|--plateaus|--ligament|--knee|--menisci|--chain|--gait N out");
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(std::vector<std::string>(argv + 1, argv + argc));
  } catch (const std::exception& error) {
    fmt::print(stderr, "make_samples: {}\n", error.what());
    return 1;
  }
}
