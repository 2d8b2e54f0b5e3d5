// dea_bench – time and memory of each stage, one line per size. What is printed and how to read it: README.md.
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <iostream>
#include <limits>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "io/feb/read_feb.h"
#include "io/febio/febio_text.h"
#include "io/results/plot_file.h"
#include "io/xplt/xplt.h"
#include "src/base/parallel.h"
#include "src/equilibrium/times.h"
#include "src/run/analysis.h"
#include "src/run/prepared.h"
#include "src/springs/press.h"
#include "tests/src/test_models.h"

namespace {

using namespace dea;

/// The least and the middle of several times of the same work [s]: the least is the program's, the rest the machine's.
struct Time {
  double least = 0.0, middle = 0.0;
};

Time summary(std::vector<double> seconds) {
  std::sort(seconds.begin(), seconds.end());
  return {seconds.front(), seconds[seconds.size() / 2]};
}

template <class Work>
double seconds_of(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

template <class Work>
Time measure(int repeats, const Work& work) {
  std::vector<double> seconds;
  for (int i = 0; i < repeats; ++i) seconds.push_back(seconds_of(work));
  return summary(seconds);
}

std::string ms(const Time& t) { return fmt::format("{:9.2f} ({:9.2f})", 1e3 * t.least, 1e3 * t.middle); }

// ---- the ladder of springs ---------------------------------------------------------------------------------------

/// The rays press_springs casts first, in the target's frame at a pose of the two bodies.
struct Rays {
  std::vector<Vector3d> origin, direction;
  std::vector<double> deep;  // thickness of both layers
};

Rays rays_at(const SpringBed& bed, const Pose& source, const Pose& target) {
  Rays rays;
  const Eigen::Matrix3d R = target.rotation.transpose() * source.rotation;
  for (std::size_t i = 0; i < bed.springs.foot.size(); ++i) {
    const Vector3d x = source.center + source.rotation * (bed.springs.foot[i] - bed.source_center);
    rays.origin.push_back(bed.target_center + target.rotation.transpose() * (x - target.center));
    rays.direction.push_back(R * bed.springs.direction[i]);
    const auto& t = bed.springs.corner_thickness[i];
    rays.deep.push_back((t[0] + t[1] + t[2]) / 3.0 + bed.max_target_thickness);
  }
  return rays;
}

/// All rays once, split among the threads as press_springs does; how many met the target.
int cast(const SpringBed& bed, const Rays& rays, std::vector<LineHit>& hits) {
  hits.resize(rays.origin.size());
  parallel_for(
      hits.size(),
      [&](std::size_t i) {
        hits[i] = bed.target.nearest_facing(rays.origin[i], rays.direction[i], -4.0 * rays.deep[i], -rays.deep[i],
                                            std::numeric_limits<double>::infinity());
      },
      256);
  return static_cast<int>(
      std::count_if(hits.begin(), hits.end(), [](const LineHit& h) { return h.point.triangle >= 0; }));
}

/// Rigid ball in a socket with a 4 mm layer of cartilage, n x n facets: 2 n^2 springs, pressed with 2000 N.
void spring_rung(int n, int threads, bool turns) {
  const auto limit = limit_threads(threads);
  JointModel model = test::concentric_spheres(n, 2000.0);
  if (turns) model.rigid_fixed.pop_back();  // the ball's
  const Settings settings = test::linear();
  Joint joint;
  SpringBeds beds;
  const Time making = measure(1, [&] {
    joint = make_joint(model, settings);
    beds = make_spring_beds(joint);
  });
  const LoadCase conditions = make_load_case(model, joint, settings, 0, 1.0);
  const std::vector<Pose> start = reference_poses(joint);
  const SpringBed& bed = beds.beds.front();
  const int repeats = std::clamp(400000 / bed.springs.size(), 3, 25);

  Equilibrium e = solve_equilibrium(joint, beds, conditions, start, start);
  const Pose source = e.poses[static_cast<std::size_t>(bed.source_body)],
             target = e.poses[static_cast<std::size_t>(bed.target_body)];
  const Rays rays = rays_at(bed, source, target);
  std::vector<LineHit> hits;
  int hit = 0;
  SpringStates states;
  std::vector<double> casts, projections, solutions, ratios;
  for (int i = 0; i < repeats; ++i) {  // in turns: a busy moment of the machine then hits all three
    casts.push_back(seconds_of([&] { hit = cast(bed, rays, hits); }));
    projections.push_back(seconds_of([&] { states = press_springs(bed, source, target); }));
    solutions.push_back(seconds_of([&] { e = solve_equilibrium(joint, beds, conditions, start, start); }));
    ratios.push_back(solutions.back() / casts.back());
  }
  const Time casting = summary(casts), projecting = summary(projections), solving = summary(solutions);

  fmt::print("{:8} {:3} {:4} {:8.1f} {} {} {} {:6.1f} {:6.1f} {:5} {:5}  {:8.1e} {}\n", bed.springs.size(), threads,
             turns ? 6 : 3, 1e3 * making.least, ms(casting), ms(projecting), ms(solving), solving.least / casting.least,
             summary(ratios).middle, e.iterations, e.casts, e.load > 0 ? e.residual_force / e.load : 0.0,
             name(e.outcome));
  if (hit == 0 || !solved(e.outcome)) throw std::runtime_error("the ball in the socket found no balance");
}

void springs(const std::vector<int>& sizes) {
  fmt::print(
      "\nOne equilibrium of a ball in a socket, law linear, from the reference pose. Times in ms: least (median).\n");
  fmt::print("{:>8} {:>3} {:>4} {:>8} {:>21} {:>21} {:>21} {:>13} {:>5} {:>5}  {:>8}\n", "springs", "thr", "dofs",
             "joint", "rays", "press_springs", "equilibrium", "equil./rays", "iter.", "casts", "unbal./load");
  std::vector<int> threads = {1};
  const int all = static_cast<int>(std::thread::hardware_concurrency());
  if (all > 1) threads.push_back(all);
  for (int t : threads)
    for (int n : sizes) spring_rung(n, t, false);
  for (int n : sizes)
    if (n <= 300) spring_rung(n, 1, true);
}

// ---- the layer law beside the springs ----------------------------------------------------------------------------

/// One equilibrium of the ball in the socket with `--law linear` and with `--law layer`.
void law_rung(int n) {
  const auto limit = limit_threads(1);
  const JointModel model = test::concentric_spheres(n, 2000.0);
  Time times[2];
  Equilibrium e;
  std::vector<double> seconds[2], ratios;
  struct Case {
    Joint joint;
    SpringBeds beds;
    LoadCase conditions;
    std::vector<Pose> start;
  };
  std::vector<Case> cases(2);
  for (std::size_t k = 0; k < 2; ++k) {
    Settings settings;
    settings.law = k == 0 ? Law::Linear : Law::Layer;
    Case& c = cases[k];
    c.joint = make_joint(model, settings);
    c.conditions = make_load_case(model, c.joint, settings, 0, 1.0);
    c.start = reference_poses(c.joint);
  }
  const int springs = make_spring_beds(cases[0].joint).beds.front().springs.size();
  const int repeats = std::clamp(60000 / springs, 1, 9);
  for (int i = 0; i < repeats; ++i) {
    for (std::size_t k = 0; k < 2; ++k) {
      Case& c = cases[k];
      seconds[k].push_back(seconds_of([&] {
        c.beds = make_spring_beds(c.joint);  // with the layers' factorisations, and nothing left to start from
        e = solve_equilibrium(c.joint, c.beds, c.conditions, c.start, c.start);
      }));
    }
    ratios.push_back(seconds[1].back() / seconds[0].back());
  }
  for (std::size_t k = 0; k < 2; ++k) times[k] = summary(seconds[k]);
  fmt::print("{:8} {} {} {:8.1f} {:9.2f} {:5} {:5}  {:8.1e} {}\n", springs, ms(times[0]), ms(times[1]),
             summary(ratios).middle, 1e6 * times[1].least / springs, e.iterations, e.casts,
             e.load > 0 ? e.residual_force / e.load : 0.0, name(e.outcome));
  if (!solved(e.outcome)) throw std::runtime_error("the ball in the socket found no balance");
}

void laws(const std::vector<int>& sizes) {
  fmt::print(
      "\nSprings and one equilibrium of the ball in the socket with both laws, one thread. Times in ms: least "
      "(median).\n");
  fmt::print("{:>8} {:>21} {:>21} {:>8} {:>9} {:>5} {:>5}  {:>8}\n", "springs", "linear", "layer", "ratio", "us/spring",
             "iter.", "casts", "unbal./load");
  for (int n : sizes) law_rung(n);
}

// ---- a whole analysis --------------------------------------------------------------------------------------------

void whole(const std::string& feb, Law law, const std::filesystem::path& folder, int repeats) {
  const std::string xplt = (folder / "bench.xplt").string();
  std::vector<double> joint, solve;
  std::size_t states = 0;
  JointModel model;
  Settings settings;
  settings.law = law;
  Analysis analysis;
  Time total;
  const Time reading = measure(repeats, [&] { model = read_feb(feb); });
  measure(repeats, [&] {
    analysis = analyse(model, settings);
    joint.push_back(analysis.seconds_joint);
    solve.push_back(analysis.seconds_solve);
    states = analysis.states.size();
  });
  const Time writing = measure(repeats, [&] { write_xplt(xplt, make_plot_file(model, analysis)); });
  const Time j = summary(joint), s = summary(solve);
  total.least = reading.least + j.least + s.least + writing.least;
  total.middle = reading.middle + j.middle + s.middle + writing.middle;
  fmt::print("\n{}, law {}, all {} states. Times in ms: least (median).\n",
             std::filesystem::path(feb).filename().string(), name(law), states);
  fmt::print("{:>21} {:>21} {:>21} {:>21} {:>21}\n{} {} {} {} {}\n", "read", "joint", "solve", "write", "all",
             ms(reading), ms(j), ms(s), ms(writing), ms(total));
}

// ---- the ladder of bodies ----------------------------------------------------------------------------------------

/// Bones in a row (tests/src/test_models.h), solved from the reference pose, one thread.
void bodies(const std::vector<int>& sizes) {
  const auto limit = limit_threads(1);
  fmt::print("\nOne equilibrium of a row of bones, one thread. Times in ms: least (median).\n");
  fmt::print("{:>8} {:>6} {:>8} {:>21} {:>10} {:>5} {:>5}  {:>8}\n", "bodies", "dofs", "springs", "equilibrium",
             "ms/body", "iter.", "casts", "unbal./load");
  for (int n : sizes) {
    const JointModel model = test::bone_chain(n, 6, 60.0);
    const Joint joint = make_joint(model, Settings{});
    const SpringBeds beds = make_spring_beds(joint);
    const LoadCase conditions = make_load_case(model, joint, Settings{}, 0, 1.0);
    const std::vector<Pose> start = reference_poses(joint);
    int springs = 0;
    for (const SpringBed& bed : beds.beds) springs += bed.springs.size();
    Equilibrium e;
    const Time t =
        measure(std::clamp(60 / n, 2, 9), [&] { e = solve_equilibrium(joint, beds, conditions, start, start); });
    fmt::print("{:8} {:6} {:8} {} {:10.3f} {:5} {:5}  {:8.1e} {}\n", n, 6 * (n - 1), springs, ms(t), 1e3 * t.least / n,
               e.iterations, e.casts, e.load > 0 ? e.residual_force / e.load : 0.0, name(e.outcome));
    if (!solved(e.outcome)) throw std::runtime_error("the row of bones found no balance: " + e.message);
  }
}

// ---- reading -----------------------------------------------------------------------------------------------------

/// A block of n^3 hexahedra as a FEBio 4.0 file.
void write_block(const std::string& path, int n) {
  std::FILE* file = std::fopen(path.c_str(), "w");
  if (!file) throw std::runtime_error("cannot write " + path);
  const auto id = [n](int i, int j, int k) { return 1 + i + (n + 1) * (j + (n + 1) * k); };
  fmt::print(file, R"(<?xml version="1.0" encoding="ISO-8859-1"?>
<febio_spec version="4.0">
	<Module type="solid"/>
	<Material>
		<material id="1" name="cartilage" type="neo-Hookean">
			<density>1</density>
			<E>11.85</E>
			<v>0.45</v>
		</material>
	</Material>
	<Mesh>
		<Nodes name="all">
)");
  for (int k = 0; k <= n; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i)
        fmt::print(file, "\t\t\t<node id=\"{}\">{:.9g},{:.9g},{:.9g}</node>\n", id(i, j, k), i / 7.0, j / 7.0, k / 7.0);
  fmt::print(file, "\t\t</Nodes>\n\t\t<Elements type=\"hex8\" name=\"block\">\n");
  int element = 0;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        fmt::print(file, "\t\t\t<elem id=\"{}\">{},{},{},{},{},{},{},{}</elem>\n", ++element, id(i, j, k),
                   id(i + 1, j, k), id(i + 1, j + 1, k), id(i, j + 1, k), id(i, j, k + 1), id(i + 1, j, k + 1),
                   id(i + 1, j + 1, k + 1), id(i, j + 1, k + 1));
  fmt::print(file, R"(		</Elements>
	</Mesh>
	<MeshDomains>
		<SolidDomain name="block" mat="cartilage"/>
	</MeshDomains>
	<Step>
		<step id="1" name="step">
			<Control>
				<analysis>STATIC</analysis>
				<time_steps>1</time_steps>
				<step_size>1</step_size>
			</Control>
		</step>
	</Step>
</febio_spec>
)");
  if (std::fclose(file) != 0) throw std::runtime_error("cannot write " + path);
}

/// Reads in a process of its own, whose peak memory then is that of reading alone.
void reading(int n, const std::filesystem::path& folder) {
  const std::string path = (folder / "block.feb").string();
  write_block(path, n);
  const double size = static_cast<double>(std::filesystem::file_size(path));
  fmt::print("\nReading a block of {0} nodes and {1} hexahedra.\n{2:>8} {3:>21} {4:>8} {5:>8} {6:>10}\n",
             (n + 1) * (n + 1) * (n + 1), n * n * n, "MB", "ms", "MB/s", "peak MB", "peak/file");
  std::fflush(stdout);
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("fork failed");
  if (child == 0) {
    int status = 1;
    try {
      const Time t = measure(3, [&] {
        if (read_feb(path).nodes.empty()) throw std::runtime_error("no nodes read");
      });
      fmt::print("{:8.1f} {} {:8.1f}", 1e-6 * size, ms(t), 1e-6 * size / t.least);
      status = 0;
    } catch (const std::exception& fault) {
      fmt::print(stderr, "{}\n", fault.what());
    }
    std::fflush(stdout);
    _exit(status);
  }
  int status = 0;
  rusage usage{};
  wait4(child, &status, 0, &usage);
  if (status != 0) throw std::runtime_error("reading failed");
  const double peak = 1024.0 * static_cast<double>(usage.ru_maxrss);  // Linux: kilobytes
  fmt::print(" {:8.1f} {:10.2f}\n", 1e-6 * peak, peak / size);
}

// ---- presses, for python_press.py --------------------------------------------------------------------------------

/// Presses a joint at the solution of its last step: as many times as each line of standard input says, and answers a
/// line with the seconds of it and the contacts' normal force, so that a script can take turns with other callers.
void serve_presses(const std::string& feb, Law law) {
  const JointModel model = read_feb(feb);
  Settings settings;
  settings.law = law;
  const Recognition recognition = recognise(model, settings);
  const Prepared joint = prepare(recognition);
  const int last = static_cast<int>(model.steps.size()) - 1;
  const LoadCase loads =
      make_load_case(recognition.model, joint.joint, recognition.settings, last, step_starts(model).back());
  const Equilibrium balance = solve(joint, loads, at_start(recognition));
  int springs = 0;
  for (const SpringBed& bed : joint.beds.beds) springs += bed.springs.size();
  fmt::print("{}\n", springs);
  for (int count = 0; std::cin >> count;) {
    double force = 0.0;
    const double seconds = seconds_of([&] {
      for (int i = 0; i < count; ++i) {
        const Pressed pressed = press(joint, balance.poses);
        force = 0.0;
        for (const PressedSprings& contact : pressed.contacts) force += contact.normal_force;
      }
    });
    fmt::print("{:.9g} {:.17g}\n", seconds, force);
  }
}

/// A folder for the files of this run, removed at its end.
struct TemporaryFolder {
  std::filesystem::path path = std::filesystem::temp_directory_path() / fmt::format("dea_bench_{}", getpid());
  TemporaryFolder() { std::filesystem::create_directories(path); }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
};

}  // namespace

int main(int argc, char** argv) {
  std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);  // a line is seen when it is measured, in a file too
  if (argc == 4 && std::string(argv[1]) == "press") {
    try {
      serve_presses(argv[2], std::string(argv[3]) == name(Law::Linear) ? Law::Linear : Law::Layer);
    } catch (const std::exception& fault) {
      fmt::print(stderr, "dea_bench: {}\n", fault.what());
      return 1;
    }
    return 0;
  }
  const std::string what = argc > 1 ? argv[1] : "all";
  const std::vector<std::string> known = {"all", "springs", "laws", "bodies", "hip", "read", "smoke"};
  const std::vector<std::string> of_sizes = {"springs", "laws", "bodies"};
  std::vector<int> sizes;
  for (int i = 2; i < argc; ++i) sizes.push_back(febio::whole_int(argv[i]).value_or(0));
  const bool bad_size = std::any_of(sizes.begin(), sizes.end(), [](int n) { return n < 1; });
  if (bad_size || (!sizes.empty() && std::find(of_sizes.begin(), of_sizes.end(), what) == of_sizes.end()) ||
      std::find(known.begin(), known.end(), what) == known.end()) {
    fmt::print(stderr,
               "usage: dea_bench [all|hip|read|smoke|springs [N...]|laws [N...]|bodies [N...]|press MODEL LAW]    "
               "springs, laws: "
               "N x N facets, 2 N^2 springs\n");
    return 2;
  }
  try {
    const TemporaryFolder folder;
    const std::string hip = DEA_SAMPLES_DIR "/hip/hip_walking.feb";
    const bool smoke = what == "smoke";
    // reading first: its process is a copy of this one, which is small yet and has one thread
    if (smoke || what == "read" || what == "all") reading(smoke ? 9 : 99, folder.path);
    if (smoke || what == "hip" || what == "all")
      for (const Law law : {Law::Linear, Law::Layer}) whole(hip, law, folder.path, smoke ? 1 : 9);
    if (smoke) springs({22});
    if (smoke) laws({22});
    if (smoke) bodies({3});
    const bool sized = !sizes.empty();
    if (what == "bodies" || what == "all") bodies(sized ? sizes : std::vector<int>{2, 5, 10, 20, 40, 42, 60, 100, 200});
    if (sizes.empty()) sizes = {22, 32, 45, 71, 100, 158, 224, 354, 500, 707};  // 1k .. 1M springs
    if (what == "springs" || what == "all") springs(sizes);
    if (what == "laws" || what == "all") laws(sized ? sizes : std::vector<int>{22, 45, 100, 158, 224, 316});  // to 200k
  } catch (const std::exception& fault) {
    fmt::print(stderr, "dea_bench: {}\n", fault.what());
    return 1;
  }
  return 0;
}
