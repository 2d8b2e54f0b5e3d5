// Bones of deformable elements that the user takes as rigid: what FEBio would do with them, or a refusal.
#include <gtest/gtest.h>

#include <algorithm>

#include "src/base/error.h"
#include "src/base/numbers.h"
#include "src/facts/bodies.h"
#include "src/run/analysis.h"
#include "tests/findings.h"
#include "tests/src/test_models.h"

namespace dea::taken_as_rigid_test {

constexpr int kPlate = 2;

/// Nodes of the elements of a material of which `keep` is true.
template <class Keep>
std::vector<int> nodes_of(const JointModel& model, int material, Keep keep) {
  std::vector<int> nodes;
  for (const Domain& d : model.domains)
    for (const int node : d.nodes)
      if (d.material == material && keep(model.nodes[at(node)])) nodes.push_back(node);
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}
bool all(const Vector3d&) { return true; }

void fix_nodes(JointModel& model, const std::string& name, const std::vector<int>& nodes, std::array<bool, 3> xyz) {
  FixedNodes f;
  f.name = name;
  f.nodes = nodes;
  f.xyz = xyz;
  model.fixed_nodes.push_back(f);
}

/// A plate of deformable shells, pushed down with 1 N at each of its nodes onto a layer.
JointModel pushed_plate() {
  JointModel model = test::flat_plates(4, 10, 2, 0.0);
  model.materials[kPlate].rigid = false;
  model.materials[kPlate].center_of_mass = Vector3d(0, 0, 0);
  NodalForce push;
  push.nodes = nodes_of(model, kPlate, all);
  push.value = {0, 0, -1};
  push.controller = 0;
  model.nodal_forces.push_back(push);
  return model;
}

Settings plate_as_rigid() {
  Settings settings = test::linear();
  settings.rigid = {"plate"};
  return settings;
}

std::string refusal(const JointModel& model, const Settings& settings) {
  try {
    analyse(model, settings);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

/// Is a sentence with these words among what is told of the joint?
bool finds(const JointModel& model, const std::string& words) {
  return test::words_of(make_joint(model, plate_as_rigid()).findings).find(words) != std::string::npos;
}

// Another bone of the same material, far away and held: one body of both would not move, and press with nothing.
TEST(TakenAsRigid, SeparateBonesOfOneMaterialAreRefused) {
  const auto far = [](const Vector3d& x) { return x.x() > 50; };
  const auto near = [](const Vector3d& x) { return x.x() < 50; };
  const auto with_another = [] {
    JointModel model = pushed_plate();
    test::add_rigid_surface(
        model, "other", 2, 2, [](double u, double v) { return Vector3d(100 + u, v, 0); }, kPlate);
    return model;
  };
  const JointModel idle = with_another();  // a piece that nothing has to do with but its surface, which no contact has
  EXPECT_EQ(refusal(idle, plate_as_rigid()), "");
  JointModel model = with_another();
  fix_nodes(model, "far", nodes_of(model, kPlate, far), {true, true, true});
  EXPECT_NE(refusal(model, plate_as_rigid()).find("is 2 pieces that nothing rigid joins (16 elements at "),
            std::string::npos)
      << refusal(model, plate_as_rigid());
  EXPECT_NE(refusal(model, plate_as_rigid()).find("give each piece a material of its own"), std::string::npos);
  Settings told = plate_as_rigid();
  told.free["plate"] = {};
  EXPECT_EQ(refusal(model, told), "");
  // held by an edge, it could still turn about it
  fix_nodes(model, "near", nodes_of(model, kPlate, [](const Vector3d& x) { return x.x() < -4.9; }), {true, true, true});
  EXPECT_NE(refusal(model, plate_as_rigid()).find("is 2 pieces"), std::string::npos);
  // in full: each stays where it is, also if the steps say so one by one
  fix_nodes(model, "near", nodes_of(model, kPlate, near), {true, true, true});
  EXPECT_EQ(refusal(model, plate_as_rigid()), "");
  model.steps.push_back(model.steps[0]);
  model.fixed_nodes.back().step = 1;
  EXPECT_NE(refusal(model, plate_as_rigid()).find("is 2 pieces"), std::string::npos);
  model.fixed_nodes.push_back(model.fixed_nodes.back());
  model.fixed_nodes.back().step = 0;
  EXPECT_EQ(refusal(model, plate_as_rigid()), "");

  // moved alike they are one body; moved each by itself they are not
  JointModel moved = with_another();
  moved.nodal_forces.clear();
  PrescribedNodes p;
  p.name = "down";
  p.nodes = nodes_of(moved, kPlate, all);
  for (p.component = 0; p.component < 3; ++p.component) {
    p.value = {p.component == 2 ? -0.1 : 0.0, 0};
    moved.prescribed_nodes.push_back(p);
  }
  EXPECT_EQ(refusal(moved, plate_as_rigid()), "");
  moved.prescribed_nodes.back().nodes = nodes_of(moved, kPlate, near);
  p.component = 2;
  p.nodes = nodes_of(moved, kPlate, far);
  p.value.factor = 0.3;
  moved.prescribed_nodes.push_back(p);
  EXPECT_NE(refusal(moved, plate_as_rigid()), "");

  // a rigid body of the model that holds nodes of both makes them one in FEBio, too
  JointModel joined = with_another();
  const int pot = test::add_material(joined, "pot", true);
  joined.materials[at(pot)].center_of_mass = Vector3d(0, 0, 20);
  test::add_rigid_surface(
      joined, "pot", 1, 1, [](double u, double v) { return Vector3d(u, v, 20); }, pot);
  RigidNodes set;
  set.material = pot;
  set.nodes = nodes_of(joined, kPlate, all);
  joined.rigid_nodes.push_back(set);
  test::fix(joined, pot, {true, true, false, true, true, true});
  EXPECT_EQ(refusal(joined, plate_as_rigid()), "");
  EXPECT_TRUE(finds(joined, "material \"plate\" is one body with \"pot\", whose centre of mass counts"));
}

// A piece of a second material, that shares no node with the first: the second one is named.
TEST(TakenAsRigid, TheMaterialOfThePieceIsNamed) {
  JointModel model = pushed_plate();
  const int cortex = test::add_material(model, "cortex", false);
  model.domains.back().name = "half";
  Domain half = model.domains.back();  // of the plate's shells
  half.material = cortex;
  model.domains.push_back(half);
  test::add_rigid_surface(
      model, "other", 2, 2, [](double u, double v) { return Vector3d(100 + u, v, 0); }, cortex);
  fix_nodes(model, "far", nodes_of(model, cortex, [](const Vector3d& x) { return x.x() > 50; }), {true, true, true});
  Settings settings = plate_as_rigid();
  settings.rigid.push_back("cortex");
  EXPECT_NE(refusal(model, settings).find("material \"cortex\" is taken as rigid"), std::string::npos)
      << refusal(model, settings);
}

// Two bones of one material that are tied to each other are one; each tied to a third thing, they are not.
TEST(TakenAsRigid, TiesJoinTwoBones) {
  JointModel model = pushed_plate();
  const int other = test::add_rigid_surface(
      model, "other", 2, 2, [](double u, double v) { return Vector3d(4 * u - 2, 2 - 4 * v, 0.5); }, kPlate);
  NodalForce push = model.nodal_forces.front();
  push.nodes = model.surfaces[at(other)].nodes;
  model.nodal_forces.push_back(push);
  EXPECT_NE(refusal(model, plate_as_rigid()).find("is 2 pieces"), std::string::npos);
  test::add_contact(model, "tie", other, model.contacts.front().secondary);
  model.contacts.back().kind = Contact::Kind::Tied;
  EXPECT_EQ(refusal(model, plate_as_rigid()).find("pieces"), std::string::npos) << refusal(model, plate_as_rigid());
}

/// A block of `bone` with z in 0 .. 1, and one of the rigid material `pot` with z in 10 .. 12 that holds its nodes.
struct Potted {
  JointModel model = test::empty_model();
  int bone = test::add_material(model, "bone", false), pot = test::add_material(model, "pot", true);
  Potted() {
    const auto block = [&](const char* name, int material, double from, double to) {
      test::add_layer(
          model, name, 1, 1, 1, [=](double u, double v) { return Vector3d(u, v, from); },
          [=](double u, double v) { return Vector3d(u, v, to); }, material, material);
    };
    block("bone", bone, 0, 1);
    block("pot", pot, 10, 12);
    RigidNodes set;
    set.material = pot;
    set.nodes = nodes_of(model, bone, all);
    model.rigid_nodes.push_back(set);
    model.materials[at(pot)].center_of_mass.reset();
  }
  Body body() const { return find_bodies(model, std::vector<char>(model.materials.size(), 1)).bodies.front(); }
};

// FEBio turns a rigid body about its own centre: what hangs on it and is deformable does not count.
// Two of them on one bone are one here, and their loads act at one centre: told.
TEST(TakenAsRigid, TheCentreOfARigidBodyOfTheModelStays) {
  Potted joint;
  EXPECT_LT((joint.body().center_of_mass - Vector3d(0.5, 0.5, 11)).norm(), 1e-12);
  EXPECT_NEAR(joint.body().mass, 2.0, 1e-12);
  joint.model.materials[at(joint.pot)].center_of_mass = Vector3d(1, 2, 3);
  EXPECT_EQ(joint.body().center_of_mass, Vector3d(1, 2, 3));
  EXPECT_TRUE(joint.body().center_given);

  JointModel model = pushed_plate();
  for (const char* name : {"near pot", "far pot"}) {
    const int pot = test::add_material(model, name, true);
    model.materials[at(pot)].center_of_mass = Vector3d(0, 0, 20);
    test::add_rigid_surface(
        model, name, 1, 1, [&](double u, double v) { return Vector3d(u, v, 20); }, pot);
    RigidNodes set;
    set.material = pot;
    set.nodes = nodes_of(model, kPlate, [&](const Vector3d& x) { return (x.x() > 0) == (name[0] == 'f'); });
    model.rigid_nodes.push_back(set);
  }
  EXPECT_TRUE(finds(model, "rigid bodies \"near pot\" and \"far pot\" of the model are one body"));
}

// A density that is a map leaves no NaN and no origin behind: that of the block is taken, and told.
TEST(TakenAsRigid, ADensityThatIsNoNumberCountsAsOne) {
  Potted joint;
  joint.model.rigid_nodes.clear();
  joint.model.materials[at(joint.bone)].density = kNaN;
  EXPECT_LT((joint.body().center_of_mass - Vector3d(0.5, 0.5, 0.5)).norm(), 1e-12);

  JointModel model = pushed_plate();
  model.materials[kPlate].density = kNaN;
  EXPECT_TRUE(finds(model, "has a density that is not one number"));

  // beside one that is a number: all of the body counts alike
  Potted two;
  two.model.rigid_nodes.clear();
  two.model.materials[at(two.bone)].density = kNaN;
  two.model.materials[at(two.pot)].rigid = false;
  two.model.materials[at(two.pot)].density = 1e-9;
  for (int& node : two.model.domains[2].nodes)  // the upper block stands on the lower one
    for (std::size_t i = 0; i < 8; ++i)
      if (two.model.nodes[at(node)].z() == 10 && two.model.nodes[i].z() == 1 &&
          two.model.nodes[i].head<2>() == two.model.nodes[at(node)].head<2>())
        node = static_cast<int>(i);
  // 1 x 1 x 1 up to z = 1, then 1 x 1 x 11 up to 12
  EXPECT_LT((two.body().center_of_mass - Vector3d(0.5, 0.5, (0.5 + 11 * 6.5) / 12)).norm(), 1e-12);
}

}  // namespace dea::taken_as_rigid_test
