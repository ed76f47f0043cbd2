// Shows which VTK files of the design a run keeps: density, topology description function and
// components of every iteration; all other fields of every n-th iteration and of the last one.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "tests/cases/program.h"
#include "tests/cases/run_json.h"

namespace flexmorph::test {
namespace {

namespace fs = std::filesystem;

/// Frames that are expected of a run of six iterations.
struct Frames {
  const char* name;
  Words changes;
  Words images, fields;  ///< Endings of the names of the files.
};
void PrintTo(const Frames& frames, std::ostream* out) { *out << frames.name; }

class DesignFrames : public ::testing::TestWithParam<Frames> {};
INSTANTIATE_TEST_SUITE_P(
    Output, DesignFrames,
    ::testing::Values(
        Frames{"default", {}, {"1", "2", "3", "4", "5", "6"}, {"last"}},
        Frames{"all",
               {"output.fields_every=1"},
               {"1", "2", "3", "4", "5", "6"},
               {"1", "2", "3", "4", "5", "6"}},
        Frames{
            "every_4th", {"output.fields_every=4"}, {"1", "2", "3", "4", "5", "6"}, {"4", "last"}},
        Frames{
            "last_is_third", {"output.fields_every=3"}, {"1", "2", "3", "4", "5", "6"}, {"3", "6"}},
        Frames{"few_frames", {"output.design_every=4", "output.fields_every=3"}, {"1", "4"}, {"4"}},
        Frames{"none", {"output.design_every=0"}, {}, {}}),
    [](const auto& each) { return std::string(each.param.name); });

/// Returns the names "STEM_00004.vti" or "STEM_last.vti" of the endings "4" or "last", sorted.
Words names_of(const std::string& stem, const Words& endings, const std::string& ending) {
  Words out;
  for (const std::string& each : endings)
    out.push_back(stem + (each == "last" ? each : std::string(5 - each.size(), '0') + each) +
                  ending);
  std::sort(out.begin(), out.end());
  return out;
}

Words files_of(const std::string& folder, const std::string& stem) {
  Words out;
  std::error_code none;  // ignored: a run without frames has no folder
  for (const auto& entry : fs::directory_iterator(folder, none))
    if (const std::string name = entry.path().filename().string(); name.starts_with(stem))
      out.push_back(name);
  std::sort(out.begin(), out.end());
  return out;
}

/// Returns the files that an index of frames names, in its order.
Words indexed(const std::string& path) {
  Words out;
  const std::string text = contents_of(path), key = "file=\"";
  for (size_t at = text.find(key); at != std::string::npos; at = text.find(key, at + 1))
    out.push_back(text.substr(at + key.size(), text.find('"', at + key.size()) - at - key.size()));
  return out;
}

bool has_array(const std::string& path, const std::string& name) {
  return contents_of(path).find("Name=\"" + name + "\"") != std::string::npos;
}

TEST_P(DesignFrames, AreThoseOfTheKeys) {
  const Frames& frames = GetParam();
  const Scratch scratch;
  const std::string run = scratch / "out", folder = run + "/design/";
  Words changes = {"output.plots=false", "output.motion_every=0",     "output.crisp_every=0",
                   "design.cell=0.01",   "design.min_thickness=0.01", "esl.every=0.02",
                   "time.end=0.04"};
  changes.insert(changes.end(), frames.changes.begin(), frames.changes.end());
  ASSERT_TRUE(is_done(flexmorph(scratch, short_run(run, changes)), run));
  const Words images = names_of("iteration_", frames.images, ".vti"),
              fields = names_of("fields_", frames.fields, ".vti"),
              lines = names_of("components_", frames.fields, ".vtp");
  EXPECT_EQ(files_of(folder, "iteration_"), images);
  EXPECT_EQ(files_of(folder, "fields_"), fields);
  EXPECT_EQ(files_of(folder, "components_"), lines);
  EXPECT_EQ(indexed(folder + "iterations.pvd"), images);
  EXPECT_EQ(indexed(folder + "fields.pvd"), fields);
  EXPECT_EQ(indexed(folder + "components.pvd"), lines);
  for (const std::string& name : images)
    for (const char* array : {"density", "tdf", "components"})
      EXPECT_TRUE(has_array(folder + name, array)) << name << " " << array;
  for (const std::string& name : fields)
    for (const char* array : {"displacement", "strain_energy", "stiffness_factor"})
      EXPECT_TRUE(has_array(folder + name, array)) << name << " " << array;
}

}  // namespace
}  // namespace flexmorph::test
