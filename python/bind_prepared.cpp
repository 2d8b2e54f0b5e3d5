#include <pybind11/stl.h>

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "io/run/spring_memory.h"
#include "python/bind.h"
#include "python/errors.h"
#include "python/plain.h"
#include "python/views.h"
#include "python/work.h"
#include "src/base/names.h"
#include "src/base/say.h"
#include "src/equilibrium/load_case.h"
#include "src/equilibrium/rows.h"
#include "src/equilibrium/times.h"
#include "src/joint/placing.h"
#include "src/model/settings_table.h"
#include "src/rules/idle_loads.h"

namespace dea::python {

namespace {

using Joint_ = std::shared_ptr<PreparedJoint>;

Joint_ prepare_joint(const std::shared_ptr<Recognised>& recognised) {
  return result_of([recognised](Work& work) {
    throw_if_any(recognised->recognition.faults);
    spring_cost_note(recognised->recognition, python_wording());
    const auto joint = std::make_shared<PreparedJoint>();
    joint->recognised = recognised;
    joint->prepared = prepare(recognised->recognition, &work.stop);
    const Recognition& r = recognised->recognition;
    joint->maps = make_field_maps(r.model, joint->prepared.joint);
    if (r.settings.inside)
      joint->inside = make_inside_maps(r.model, r.settings, joint->prepared.joint, joint->prepared.beds);
    return joint;
  });
}

std::size_t body_at(const PreparedJoint& joint, const std::string& name) {
  const int found = joint.prepared.joint.find_body(joint.recognised->recognition.model, name);
  return found >= 0 ? at(found) : find_name("body", name, names_of(joint.prepared.joint.bodies));
}

/// What a user says of poses: None, a dictionary by bodies, an array of all bodies, or a state. Bodies that are not
/// named have those of `poses`.
std::vector<Pose> with_poses(const PreparedJoint& joint, std::vector<Pose> poses, const py::object& given,
                             const std::string& where) {
  const std::vector<Body>& bodies = joint.prepared.joint.bodies;
  if (given.is_none()) return poses;
  if (py::hasattr(given, "poses")) return with_poses(joint, std::move(poses), given.attr("poses"), where);
  if (py::isinstance<py::dict>(given)) {
    for (const auto& item : given.cast<py::dict>()) {
      const std::string name = py::str(item.first);
      const std::size_t b = body_at(joint, name);
      poses[b] = pose_of(item.second, bodies[b].center_of_mass, fmt::format("{}[\"{}\"]", where, name));
    }
    return poses;
  }
  const bool is_list = py::isinstance<py::list>(given) || py::isinstance<py::tuple>(given) ||
                       (py::isinstance<py::array>(given) && given.cast<py::array>().ndim() > 0);
  if (!is_list)
    throw UsageError(
        Fault{.place = where,
              .found = "found no poses,",
              .expected = "expected {\"BODY\": 4 x 4 array, ...}, an array of shape (bodies, 4, 4), or a state"});
  const std::size_t count = py::len(given);
  if (count != bodies.size())
    throw UsageError(Fault{
        .place = where,
        .found = fmt::format("found {} poses,", count),
        .expected = fmt::format("expected one for each of {} bodies, or {{\"BODY\": 4 x 4 array}}", bodies.size())});
  for (std::size_t b = 0; b < count; ++b)
    poses[b] = pose_of(given.attr("__getitem__")(b), bodies[b].center_of_mass, fmt::format("{}[{}]", where, b));
  return poses;
}

/// The load that a user puts on one body.
struct GivenLoad {
  std::string body;  ///< empty: the model's own
  Vector6 load = Vector6::Zero();
};

Vector3d three_numbers(const py::object& given, const char* where) {
  if (given.is_none()) return Vector3d::Zero();
  if (py::isinstance<py::dict>(given))
    throw UsageError(Fault{.place = where,
                           .found = "found a dictionary,",
                           .expected = "expected (x, y, z), with body=\"BODY\" beside it"});
  const auto array = DoubleArray::ensure(given);
  if (!array) PyErr_Clear();
  if (!array || array.ndim() != 1 || array.shape(0) != 3)
    throw UsageError(Fault{.place = where, .found = "found no three numbers,", .expected = "expected (x, y, z)"});
  const Vector3d v = Eigen::Map<const Vector3d>(array.data());
  if (!v.allFinite())
    throw UsageError(
        Fault{.place = where, .found = "found a number that is not finite,", .expected = "expected (x, y, z)"});
  return v;
}

/// The settings of a load case: those of the recognition, with the load as a table of one row. Of a table of motion the
/// last row stays, as it does without a load.
Settings settings_with(const PreparedJoint& joint, const SaidValues& values, const GivenLoad& given) {
  const Recognition& r = joint.recognised->recognition;
  Settings settings = with_values(r.settings, values);
  check_body_names(r.model, joint.prepared.joint.bodies, settings);
  if (given.body.empty()) return settings;
  if (!settings.loads.time.empty() && settings.loads.body != given.body)
    throw UsageError(
        Fault{.place = "body",
              .found = fmt::format("found \"{}\", and a table of loads on \"{}\",", given.body, settings.loads.body),
              .expected = "expected the table's body, or a recognition without the table"});
  double time = step_starts(r.model).back();
  if (!settings.motion.time.empty()) {
    time = settings.motion.time.back();
    settings.motion.time = {time};
    settings.motion.motion = {settings.motion.motion.back()};
  }
  settings.force.erase(given.body);
  settings.force_frame.erase(given.body);
  settings.loads = {};
  settings.loads.body = given.body;
  settings.loads.time = {time};
  settings.loads.load = {given.load};
  return settings;
}

LoadCase load_case_of(const PreparedJoint& joint, const Settings& settings, const std::vector<Pose>& placed) {
  const JointModel& model = joint.recognised->recognition.model;
  if (row_count(settings) == 0)
    return make_load_case(model, joint.prepared.joint, settings, static_cast<int>(model.steps.size()) - 1,
                          step_starts(model).back());
  check_rows(model, joint.prepared.joint, settings);
  return make_row_case(model, joint.prepared.joint, settings, static_cast<int>(row_count(settings)) - 1, placed,
                       placed);
}

/// A start says where free dofs begin; what is held stays where the settings place it, whatever state the start is
/// taken from. `said`: the user named the bodies, and would be surprised.
std::vector<Pose> free_start(const PreparedJoint& joint, const LoadCase& load_case, const std::vector<Pose>& placed,
                             const std::vector<Pose>& start, bool said) {
  constexpr double kSame = 1e-9;
  std::vector<Pose> poses = placed;
  for (std::size_t b = 0; b < poses.size(); ++b) {
    const auto& dofs = load_case.bodies[b].dofs;
    for (int k = 0; k < 3; ++k)
      if (dofs[at(k)] == DofState::Free) poses[b].center(k) = start[b].center(k);
    if (std::count(dofs.begin() + 3, dofs.end(), DofState::Free) > 0) poses[b].rotation = start[b].rotation;
    const double away = (poses[b].center - start[b].center).norm() + (poses[b].rotation - start[b].rotation).norm();
    if (said && away > kSame * (1 + placed[b].center.norm()))
      throw UsageError(Fault{.place = fmt::format("start[\"{}\"]", joint.prepared.joint.bodies[b].name),
                             .found = "found a motion that the body is not free to make,",
                             .expected = "expected rotate or move for where it is held"});
  }
  return poses;
}

std::shared_ptr<SolvedLoad> solved_load(const Joint_& joint, const LoadCase& load_case, const Start& start,
                                        Work& work) {
  EquilibriumOptions options;
  options.stop = &work.stop;
  options.watch = [&work](const SearchStatus& s) {
    work.tell({.stage = "state", .state = 1, .states = 1, .iterations = s.iterations, .residual = s.residual});
  };
  const Prepared& p = joint->prepared;
  const Recognition& r = joint->recognised->recognition;
  const auto solved = std::make_shared<SolvedLoad>();
  solved->joint = joint;
  StateResult& state = solved->state;
  state.when = {load_case.time, load_case.step, -1};
  state.equilibrium = solve(p, load_case, start, options);
  refuse_zero_thickness(r.model, p.joint, p.beds, state.equilibrium);
  if (dea::solved(state.equilibrium.outcome))
    refuse_left_planes(r.model, p.joint, state.equilibrium.poses, load_case.time);
  add_fields(p, joint->maps, joint->inside ? &*joint->inside : nullptr, state);
  state.displacements =
      node_displacements(r.model, p.joint, joint->maps, state.equilibrium, state.fields, r.settings.squash);
  return solved;
}

GivenLoad given_load(const PreparedJoint& joint, const std::string& body, const py::object& force,
                     const py::object& moment) {
  GivenLoad given;
  given.load << three_numbers(force, "force"), three_numbers(moment, "moment");
  const bool loaded = !force.is_none() || !moment.is_none();
  if (!body.empty()) given.body = joint.prepared.joint.bodies[body_at(joint, body)].name;
  if (body.empty() && loaded)
    throw UsageError(Fault{.place = force.is_none() ? "moment" : "force",
                           .found = "found no body that it acts on,",
                           .expected = "expected body=\"BODY\" beside it"});
  if (!body.empty() && !loaded)
    throw UsageError(Fault{.place = "body",
                           .found = fmt::format("found \"{}\" without a load,", body),
                           .expected = "expected force=(x, y, z), moment=(x, y, z) or both beside it"});
  return given;
}

/// A load of this call that the body cannot follow: UsageError if nothing of it has an effect, else a warning. Also one
/// of the recognition.
void check_loads(const PreparedJoint& joint, const Settings& settings, const GivenLoad& given) {
  for (const IdleLoad& idle : idle_loads(joint.recognised->recognition.model, joint.prepared.joint, settings)) {
    const bool of_call = !given.body.empty() && idle.given.setting == "loads";
    const bool of_force = std::any_of(idle.lost.begin(), idle.lost.begin() + 3, [](bool lost) { return lost; });
    const char* place = of_force ? "force" : "moment";
    const std::string words = idle_in_words(idle);
    if (!idle.all) {
      if (of_call && PyErr_WarnEx(PyExc_UserWarning, message_line(fmt::format("{}: {}", place, words)).c_str(), 2) != 0)
        throw py::error_already_set();
      continue;
    }
    Fault fault{.found = words + ";", .expected = instead_of(idle)};
    if (of_call)
      fault.place = place;
    else
      fault.given = idle.given;
    throw UsageError(fault);
  }
}

StateView solve_joint(const Joint_& joint, const std::string& body, const py::object& force, const py::object& moment,
                      const SaidValues& values, const py::object& start, const py::object& progress) {
  const GivenLoad given = given_load(*joint, body, force, moment);
  const Settings settings = settings_with(*joint, values, given);
  check_loads(*joint, settings, given);
  const std::vector<Pose> placed =
      starting_poses(joint->recognised->recognition.model, joint->prepared.joint, settings);
  const LoadCase load_case = load_case_of(*joint, settings, placed);
  const std::vector<Pose> poses = free_start(*joint, load_case, placed, with_poses(*joint, placed, start, "start"),
                                             py::isinstance<py::dict>(start));
  const auto solved = result_of(
      [joint, load_case, poses, placed](Work& work) {
        return solved_load(joint, load_case, {poses, placed}, work);
      },
      progress);
  return view_of(solved);
}

/// Worked out when it is asked for: most presses are of the forces alone.
Headline headline_of(const PressedJoint& pressed, std::size_t contact) {
  const PreparedJoint& joint = *pressed.joint;
  StateResult state;
  state.equilibrium.poses = pressed.poses;
  for (const PressedSprings& c : pressed.pressed.contacts) {
    state.equilibrium.springs.push_back(c.springs);
    state.equilibrium.contact_on_target.push_back(c.on_target);
  }
  add_fields(joint.prepared, joint.maps, nullptr, state);
  return state.statistics[contact].headline;
}

/// A press that is over before Ctrl-C could be felt: the way to another thread and back would be a good part of it.
bool is_quick(const Prepared& prepared) {
  constexpr int kSprings = 50000;  // independent ones: about 50 ms
  int springs = 0;
  for (const SpringBed& bed : prepared.beds.beds) {
    if (bed.layers) return false;
    springs += bed.springs.size();
  }
  return springs <= kSprings;
}

std::shared_ptr<PressedJoint> press_joint(const Joint_& joint, const py::object& poses) {
  const std::vector<Pose> all = with_poses(*joint, reference_poses(joint->prepared.joint), poses, "pose");
  refuse_left_planes(joint->recognised->recognition.model, joint->prepared.joint, all, std::nullopt);
  std::optional<LoadCase> loads;
  if (!joint->prepared.beds.ties.empty()) {
    const Recognition& r = joint->recognised->recognition;
    loads = load_case_of(*joint, r.settings, starting_poses(r.model, joint->prepared.joint, r.settings));
  }
  const auto pressed = [joint, all, loads](const StopFlag* stop) {
    PressOptions options;
    options.stop = stop;
    return std::make_shared<PressedJoint>(
        PressedJoint{joint, all, press(joint->prepared, all, options, nullptr, loads ? &*loads : nullptr)});
  };
  if (is_quick(joint->prepared)) return unlocked([&] { return pressed(nullptr); });
  return result_of([pressed](Work& work) { return pressed(&work.stop); });
}

struct PressedView {
  std::shared_ptr<const PressedJoint> of;
  std::size_t index = 0;
  const PressedSprings& contact() const { return of->pressed.contacts[index]; }
};

void bind_joint(py::module_& m) {
  Class<PreparedJoint, Joint_>(
      m, "Prepared",
      "A joint made ready once: springs placed, layers factorised. It never changes; several threads may use one at a\n"
      "time, and the same call gives the same bits.\n\nMade by prepare.")
      .value("recognition", "What it was prepared from.",
             [](const PreparedJoint& j) { return std::const_pointer_cast<Recognised>(j.recognised); })
      .value("bodies", "Names of the rigid bodies, in the order of arrays of poses.",
             [](const PreparedJoint& j) { return names_of(j.prepared.joint.bodies); })
      .value("contacts", "Names of the contacts.",
             [](const PreparedJoint& j) { return names_of(j.prepared.joint.contacts); })
      .def("_solve", &solve_joint)
      .def("press", &press_joint, py::arg("pose") = py::none(),
           "All contacts at given poses, without a search for the poses.\n\n"
           "pose: {\"BODY\": 4 x 4 array, ...}, bodies that are not named stay where the file has them; or an array\n"
           "(bodies, 4, 4); or a state. x = R X + t: the identity leaves a body where the file has it. Global frame,\n"
           "the model's units. Springs on parts that give way pull as at the end of the model's last step. Answers a "
           "Pressed.\n"
           "Raises UsageError.")
      .def("__repr__", [](const PreparedJoint& j) {
        return text(fmt::format("<febiodea.Prepared: {} bodies, {} contacts>", j.prepared.joint.bodies.size(),
                                j.prepared.joint.contacts.size()));
      });
}

void bind_pressed_contact(py::module_& m) {
  Class<PressedView>(m, "PressedContact", "What one contact does at given poses.")
      .value("name", "Of the contact.",
             [](const PressedView& v) { return v.of->joint->prepared.joint.contacts[v.index].name; })
      .value("springs", "Its springs: arrays, one entry per spring.",
             [](const PressedView& v) {
               return SpringsView{v.of, &v.contact().springs};
             })
      .value("force", "(3,) on the target, global.",
             [](const PressedView& v) { return vector3(v.contact().on_target.head<3>()); })
      .value("moment", "(3,) on the target, about its current centre of mass.",
             [](const PressedView& v) { return vector3(v.contact().on_target.tail<3>()); })
      .value("force_on_source", "(3,) the opposite force.",
             [](const PressedView& v) { return vector3(v.contact().on_source.head<3>()); })
      .value("moment_on_source", "(3,) on the source, about its current centre of mass.",
             [](const PressedView& v) { return vector3(v.contact().on_source.tail<3>()); })
      .value("derivative",
             "(6, 6) of (force, moment) by small motions of the target (translation of its centre of\n"
             "mass, rotation [rad], global axes), the source held.",
             [](const PressedView& v) { return matrix6(v.contact().derivative); })
      .value("stiffness", "(6, 6) minus `derivative`: what resists the motion.",
             [](const PressedView& v) { return matrix6(-v.contact().derivative); })
      .value("normal_force", "Sum of pressure times area.",
             [](const PressedView& v) { return v.contact().normal_force; })
      .value("headline", "p99, mean, area, peak of the pressure above `above` (docs/theory.md, 6.1).",
             [](const PressedView& v) { return unlocked([&] { return headline_of(*v.of, v.index); }); })
      .def("__repr__", [](const PressedView& v) {
        return text(fmt::format("<febiodea.PressedContact {}: normal force {:.4g}>",
                                v.of->joint->prepared.joint.contacts[v.index].name, v.contact().normal_force));
      });
}

void bind_pressed(py::module_& m) {
  bind_pressed_contact(m);
  Class<PressedJoint, std::shared_ptr<PressedJoint>>(m, "Pressed", "All contacts of a joint at given poses.")
      .def(
          "contact",
          [](const std::shared_ptr<PressedJoint>& p, const std::string& name) {
            return PressedView{p, find_name("contact", name, names_of(p->joint->prepared.joint.contacts))};
          },
          py::arg("name") = "", "The contact of this name; without a name: the only one.")
      .value("contacts", "One PressedContact per contact of the joint.",
             [](const std::shared_ptr<PressedJoint>& p) {
               return list_of(p->pressed.contacts.size(), [&](std::size_t c) { return PressedView{p, c}; });
             })
      .value("on_body", "Per body (force, moment) of all contacts, about its current centre of mass, global.",
             [](const PressedJoint& p) {
               py::dict all;
               for (std::size_t b = 0; b < p.pressed.on_body.size(); ++b)
                 all[text(p.joint->prepared.joint.bodies[b].name)] = force_and_moment(p.pressed.on_body[b]);
               return all;
             })
      .value("poses", "Per body its pose, (4, 4).",
             [](const PressedJoint& p) {
               py::dict all;
               const std::vector<Body>& bodies = p.joint->prepared.joint.bodies;
               for (std::size_t b = 0; b < bodies.size(); ++b)
                 all[text(bodies[b].name)] = matrix_of(p.poses[b], bodies[b].center_of_mass);
               return all;
             })
      .def("__repr__", [](const PressedJoint& p) {
        return fmt::format("<febiodea.Pressed: {} contact{}>", p.pressed.contacts.size(),
                           p.pressed.contacts.size() == 1 ? "" : "s");
      });
}

}  // namespace

void bind_prepared(py::module_& m) {
  bind_joint(m);
  bind_pressed(m);
  m.def("prepare", &prepare_joint);
}

}  // namespace dea::python
