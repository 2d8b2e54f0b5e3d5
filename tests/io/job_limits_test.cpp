// What control groups and batch systems say of memory and processors, from files and variables as they have them.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include "io/feb/read_feb.h"
#include "io/files/free_memory.h"
#include "io/settings/settings_xml.h"
#include "io/surfaces/read_surface.h"
#include "io/tables/table.h"
#include "io/xplt/xplt.h"
#include "src/base/error.h"

namespace dea::job_limits_test {

namespace fs = std::filesystem;

/// A folder as /sys/fs/cgroup.
class Groups {
 public:
  Groups() : root_(fs::temp_directory_path() / ("dea_groups_" + std::to_string(::getpid()))) {
    fs::create_directories(root_);
  }
  ~Groups() { fs::remove_all(root_); }
  void write(const std::string& name, const std::string& text) const {
    fs::create_directories((root_ / name).parent_path());
    std::ofstream(root_ / name) << text;
  }
  double free(const std::string& memberships) const {
    write("memberships", memberships);
    return free_of_groups((root_ / "memberships").string(), root_.string());
  }

 private:
  fs::path root_;
};

TEST(JobLimits, TheLeastOfAGroupAndThoseAboveIt) {
  const Groups groups;
  EXPECT_TRUE(std::isinf(groups.free("0::/\n"))) << "no limit anywhere";
  groups.write("job/memory.max", "max\n");
  groups.write("job/memory.stat", "anon 300\nfile 9000\n");
  groups.write("job/step/memory.max", "1000\n");
  groups.write("job/step/memory.stat", "file 9000\nanon 300\n");
  EXPECT_EQ(groups.free("1:cpu:/elsewhere\n0::/job/step\n"), 700) << "pages of files can be given back";
  groups.write("job/memory.max", "900\n");
  EXPECT_EQ(groups.free("0::/job/step\n"), 600);
  groups.write("job/memory.stat", "anon 1200\n");
  EXPECT_EQ(groups.free("0::/job/step\n"), 0) << "more than it may";
  EXPECT_TRUE(std::isinf(groups.free("0::/another\n")));
  groups.write("memory.max", "5000\n");  // a container sees its own group as the root
  groups.write("memory.stat", "anon 1000\n");
  EXPECT_EQ(groups.free("0::/not/mounted/here\n"), 4000);
}

TEST(JobLimits, GroupsOfTheFirstVersion) {
  const Groups groups;
  groups.write("memory/slurm/job_7/memory.limit_in_bytes", "2000\n");
  groups.write("memory/slurm/job_7/memory.stat", "rss 100\ntotal_cache 5\ntotal_rss 500\n");
  groups.write("memory/slurm/memory.limit_in_bytes", "9223372036854771712\n");
  groups.write("memory/slurm/memory.stat", "total_rss 700\n");
  EXPECT_EQ(groups.free("9:name=systemd:/x\n4:cpu,memory:/slurm/job_7\n0::/\n"), 1500);
  EXPECT_GT(groups.free("4:memory:/slurm\n"), 1e18);
  EXPECT_TRUE(std::isinf(groups.free("4:memory_and_more:/slurm/job_7\n")));
}

/// Variables for as long as it lives; all that these functions look at are otherwise not there.
class Variables {
 public:
  explicit Variables(const std::map<std::string, std::string>& values) {
    for (const char* name :
         {"SLURM_MEM_PER_NODE", "SLURM_MEM_PER_CPU", "SLURM_CPUS_ON_NODE", "SLURM_CPUS_PER_TASK",
          "SLURM_STEP_TASKS_PER_NODE", "SLURM_NODEID", "OMPI_COMM_WORLD_LOCAL_SIZE", "MPI_LOCALNRANKS"})
      ::unsetenv(name);
    for (const auto& value : values) ::setenv(value.first.c_str(), value.second.c_str(), 1);
    names_ = values;
  }
  ~Variables() {
    for (const auto& value : names_) ::unsetenv(value.first.c_str());
  }

 private:
  std::map<std::string, std::string> names_;
};

TEST(JobLimits, MemoryOfASlurmJob) {
  constexpr double kMegabyte = 1024 * 1024;
  const auto memory = [](const std::map<std::string, std::string>& values) {
    const Variables variables(values);
    return memory_of_job();
  };
  EXPECT_TRUE(std::isinf(memory({})));
  EXPECT_EQ(memory({{"SLURM_MEM_PER_NODE", "1000"}}), 1000 * kMegabyte);
  EXPECT_EQ(memory({{"SLURM_MEM_PER_CPU", "600"}, {"SLURM_CPUS_ON_NODE", "3"}}), 1800 * kMegabyte);
  EXPECT_TRUE(std::isinf(memory({{"SLURM_MEM_PER_NODE", "0"}}))) << "all that the node has";
  EXPECT_TRUE(std::isinf(memory({{"SLURM_MEM_PER_CPU", "600"}})));
  EXPECT_TRUE(std::isinf(memory({{"SLURM_MEM_PER_NODE", "many"}})));
  const Variables little(std::map<std::string, std::string>{{"SLURM_MEM_PER_NODE", "1"}});
  EXPECT_EQ(free_memory(), 0) << "this process holds more than a megabyte";
}

template <class Read>
std::string refusal(Read read) {
  try {
    read();
  } catch (const InputError& e) {
    return e.what();
  }
  return "nothing thrown";
}

// Files of holes: they have 2 GB, and take no place on the disk.
TEST(FreeMemory, WhatDoesNotFitIsRefusedBeforeItIsRead) {
  const fs::path folder = fs::temp_directory_path() / ("dea_large_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  const auto large = [&](const std::string& name) {
    const std::string path = (folder / name).string();
    std::ofstream(path) << "<?xml version=\"1.0\"?>\n";
    fs::resize_file(path, 2'000'000'000);
    return path;
  };
  {
    const Variables little(std::map<std::string, std::string>{{"SLURM_MEM_PER_NODE", "1"}});
    const auto expect = [&](const std::string& path, const std::string& needs, const std::string& found) {
      EXPECT_EQ(found, path + ": to read it needs about " + needs +
                           " of memory, and 0 GB are free: take a smaller file, or a machine with more memory");
    };
    const std::string feb = large("m.feb"), stl = large("s.stl"), csv = large("t.csv"), xml = large("s.xml"),
                      xplt = large("r.xplt");
    expect(feb, "16 GB", refusal([&] { read_feb(feb); }));
    expect(stl, "8 GB", refusal([&] { read_surface(stl); }));
    expect(csv, "40 GB", refusal([&] { read_text_table(csv); }));
    expect(xml, "20 GB", refusal([&] { read_settings_file(xml); }));
    expect(xplt, "4 GB", refusal([&] { read_xplt(xplt); }));
  }
  fs::remove_all(folder);
}

TEST(FreeMemory, WhatNeverEndsIsRefused) {
  EXPECT_EQ(refusal([] { read_surface("/dev/zero"); }),
            "/dev/zero: found more than 1 GB in something that is no file, expected less: save it as one");
}

TEST(JobLimits, TasksAndProcessorsOfANode) {
  const auto tasks = [](const std::map<std::string, std::string>& values) {
    const Variables variables(values);
    return std::pair(tasks_on_node(), processors_of_task());
  };
  const char *counts = "SLURM_STEP_TASKS_PER_NODE", *node = "SLURM_NODEID";
  EXPECT_EQ(tasks({}), std::pair(1, 0));
  EXPECT_EQ(tasks({{counts, "2"}}), std::pair(2, 0));
  EXPECT_EQ(tasks({{counts, "4(x3),2"}, {node, "2"}}), std::pair(4, 0));
  EXPECT_EQ(tasks({{counts, "4(x3),2"}, {node, "3"}}), std::pair(2, 0));
  EXPECT_EQ(tasks({{counts, "4(x3),2"}, {node, "4"}}), std::pair(1, 0)) << "no such node";
  EXPECT_EQ(tasks({{counts, "4(x"}, {node, "1"}}), std::pair(1, 0));
  EXPECT_EQ(tasks({{counts, "3"}, {"SLURM_CPUS_ON_NODE", "16"}}), std::pair(3, 5));
  EXPECT_EQ(tasks({{counts, "3"}, {"SLURM_CPUS_ON_NODE", "16"}, {"SLURM_CPUS_PER_TASK", "4"}}), std::pair(3, 4));
  EXPECT_EQ(tasks({{"OMPI_COMM_WORLD_LOCAL_SIZE", "8"}, {"SLURM_CPUS_ON_NODE", "4"}}), std::pair(8, 1));
  EXPECT_EQ(tasks({{"MPI_LOCALNRANKS", "2"}}), std::pair(2, 0));
}

}  // namespace dea::job_limits_test
