// Shows that GNU parallel runs the rows of a study, and that the script of a job array runs them,
// continues interrupted ones and leaves out complete ones. Commands of Slurm are replaced by
// scripts; tests/hosts.sh runs a study on real ssh servers.

#include <gtest/gtest.h>

#include <filesystem>

#include "cases/study/rows.h"
#include "io/files.h"
#include "io/tables.h"
#include "tests/cases/program.h"
#include "tests/support/errors.h"

namespace flexmorph::cases {
namespace {

using test::Ended;
using test::Words;
namespace fs = std::filesystem;

Words sweep(const std::string& folder, const Words& more) {
  Words out = {"sweep",     "plate_pendulum",     "-o",     folder,
               "--program", FLEXMORPH_PROGRAM,    "--vary", "body.thickness=0.01,0.012",
               "--vary",    "time.step=1e-3,5e-4"};
  for (const char* change : {"body.elements=[2, 2]", "time.end=0.01", "output.vtk=false",
                             "output.plots=false", "expect=", "accuracy="})
    out.insert(out.end(), {"--set", change});
  out.insert(out.end(), more.begin(), more.end());
  return out;
}

bool has_parallel() { return testing::run_shell("parallel --version >/dev/null").code == 0; }

TEST(Hosts, RunTheRowsThatHaveNoResults) {
  if (!has_parallel()) GTEST_SKIP() << "GNU parallel is not installed";
  const Scratch scratch;
  const std::string folder = scratch / "study", machines = scratch.write("machines", "2/:\n");
  const Words words = sweep(folder, {"--hosts", machines, "--shared-disk"});
  const Ended first = test::flexmorph(scratch, words);
  ASSERT_EQ(first.code, 0) << first.out << first.err << contents_of(folder + "/parallel.out");
  EXPECT_EQ(io::read_csv(folder + "/rows.csv").texts("status"), Words(4, "done"));
  for (int n = 1; n <= 4; ++n)
    EXPECT_TRUE(contains(first.out, std::to_string(n) + "/4 ")) << first.out;

  // The second call runs only the row that was removed.
  fs::remove_all(folder + "/step=1e-3,thickness=0.012");
  const Ended second = test::flexmorph(scratch, words);
  EXPECT_EQ(second.code, 0) << second.err;
  EXPECT_TRUE(contains(second.out, "4/4 step=1e-3,thickness=0.012: done"));
  EXPECT_FALSE(contains(second.out, "3/4 "));
  EXPECT_EQ(io::read_csv(folder + "/rows.csv").texts("status"), Words(4, "done"));
}

TEST(Hosts, AreNotGivenFilesOutsideOfTheWorkingDirectory) {
  const Scratch scratch;
  const std::string machines = scratch.write("machines", ":\n");
  const Ended ended = test::flexmorph(scratch, sweep(scratch / "study", {"--hosts", machines}));
  EXPECT_EQ(ended.code, 2) << ended.out;
  EXPECT_FALSE(fs::exists(scratch / "study"));
  const Ended two =
      test::flexmorph(scratch, sweep(scratch / "study", {"--hosts", machines, "--commands"}));
  EXPECT_EQ(two.code, 2);  // the study is run in one place
}

// The script is executed as Slurm does, once per number of the array.
TEST(JobArray, RunsTheRowsAndContinuesInterruptedOnes) {
  const Scratch scratch;
  const std::string folder = scratch / "study";
  const Words words = sweep(folder, {"--sbatch", "--time=4:00:00 --mem=8G"});
  const Ended printed = test::flexmorph(scratch, words);
  ASSERT_EQ(printed.code, 0) << printed.err;
  for (const char* option :
       {"--array=1-4\n", "--requeue", "--signal=TERM@60", "#SBATCH --time=4:00:00 --mem=8G\n"})
    EXPECT_TRUE(contains(printed.out, option));
  // `srun` executes its arguments; `scontrol` notes them.
  scratch.write("srun", "#!/bin/sh\nexec \"$@\"\n");
  scratch.write("scontrol", "#!/bin/sh\necho \"$@\" >>" + scratch / "requeued" + "\n");
  const std::string script = scratch.write("job.sh", contents_of(scratch / "stdout"));
  for (const char* name : {"srun", "scontrol"})
    fs::permissions(scratch / name, fs::perms::owner_all);
  const auto task = [&](int number) {
    return testing::run_shell("PATH=" + scratch / "" +
                              ":$PATH SLURM_ARRAY_JOB_ID=9 SLURM_ARRAY_TASK_ID=" +
                              std::to_string(number) + " bash " + script);
  };
  EXPECT_EQ(task(1).code, 0);
  EXPECT_EQ(task(3).code, 0);
  EXPECT_FALSE(fs::exists(scratch / "requeued"));
  EXPECT_TRUE(contains(test::flexmorph(scratch, words).out, "--array=2,4\n"));
  EXPECT_EQ(task(2).code, 0);
  EXPECT_EQ(task(4).code, 0);
  EXPECT_EQ(test::flexmorph(scratch, sweep(folder, {"--collect"})).code, 0);
  EXPECT_EQ(test::flexmorph(scratch, words).code, 2);  // no row is left

  // A run that is interrupted ends with exit code 4 and is queued again.
  scratch.write("srun", "#!/bin/sh\nexit 4\n");
  EXPECT_EQ(task(1).code, 4);
  EXPECT_EQ(contents_of(scratch / "requeued"), "requeue 9_1\n");
}

}  // namespace
}  // namespace flexmorph::cases
