// The plan of a fleet and what is said of it; tests/fleet/test.sh does one on a real Slurm.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <cstdlib>
#include <filesystem>
#include <thread>

#include "apps/common/interruption.h"
#include "apps/fleet/fleet_report.h"
#include "apps/fleet/plan.h"
#include "nn/base/error.h"
#include "nn/base/file.h"
#include "tests/support/expect_error.h"
#include "tests/support/test_data.h"

namespace penumbra::apps {
namespace {

namespace fs = std::filesystem;

class Fleet : public ::testing::Test {
 protected:
  void write(const fs::path& path, const std::string& text) const {
    fs::create_directories((folder / path).parent_path());
    nn::write_file(folder / path, text);
  }
  std::vector<FleetRecording> read(const std::string& manifest) const {
    write("manifest.txt", manifest);
    return read_fleet_manifest(folder / "manifest.txt");
  }

  const test::TemporaryDirectory temporary;
  const fs::path folder = temporary.path();
};

TEST_F(Fleet, AManifestIsWordsAsAShellHasThem) {
  write("new bags/1.mcap", "");
  write("rig.yaml", "");
  write("my settings.json", "{}");
  const fs::path before = fs::current_path();
  const std::vector<FleetRecording> found = read(
      "# the night\n\n"
      "monday  'new bags/1.mcap' -   # no calibration\n"
      "tues.2 new\\ bags/1.mcap rig.yaml --frames 0:30 --settings \"my settings.json\"\n");
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].name, "monday");
  EXPECT_EQ(found[0].arguments, (std::vector<std::string>{"new bags/1.mcap"}));
  EXPECT_EQ(found[1].arguments,
            (std::vector<std::string>{"new bags/1.mcap", "--camera", "rig.yaml", "--frames", "0:30",
                                      "--settings", "my settings.json"}));
  EXPECT_EQ(fs::current_path(), before);
}

TEST_F(Fleet, AManifestIsRefusedBeforeAThousandJobsFail) {
  write("a.bag", "");
  const struct {
    std::string text;
    std::vector<std::string> parts;
  } cases[] = {
      {"# nothing\n", {"manifest.txt", "a recording a line"}},
      {"\na a.bag\n", {"manifest.txt:2", "a calibration (or -)"}},
      {"a 'a.bag -\n", {"manifest.txt:1", "a second '"}},
      {"a/b a.bag -\n", {"letters, digits", "a/b"}},
      {".. a.bag -\n", {"letters, digits"}},
      {"a b.bag -\n", {"a recording", "b.bag, which is not there"}},
      {"a a.bag rig.yaml\n", {"a calibration", "rig.yaml"}},
      {"a a.bag -\nb a.bag -\na a.bag -\n", {"manifest.txt:3", "a name of its own", "line 1"}},
      {"a a.bag - --frams 3\n", {"manifest.txt:1", "options of penumbra slam", "--frams"}},
      {"a a.bag - --filter sometimes\n", {"--filter"}},
      {"a a.bag - --frames 100\n", {"manifest.txt:1", "--frames: expected A:B", "found '100'"}},
      {"a a.bag - --frames 100:20\n", {"--frames", "A < B", "100:20"}},
      {"a a.bag - --frames 1.5:20\n", {"--frames", "whole numbers", "1.5:20"}},
      {"a a.bag - --frames ''\n", {"--frames"}},
      {"a a.bag - --segmentation every-0\n", {"--segmentation: expected 'keyframes'", "found 'every-0'"}},
      {"a a.bag - --settings none.json\n", {"none.json"}},
      {"a a.bag - --settings a.bag\n", {"manifest.txt:1", "settings that penumbra slam accepts", "a.bag"}},
      {"a a.bag - --masks no/masks\n", {"manifest.txt:1", "--masks names", "no/masks, which is not there"}},
      {"a a.bag - --weights=no.pth\n", {"--weights names", "no.pth"}},
      {"a a.bag - --weights a.bag --classes no.txt\n", {"--classes names", "no.txt"}},
      {"a a.bag - --out elsewhere\n", {"that the plan gives", "--out"}},
      {"a a.bag - --save-map=x.map\n", {"--save-map"}},
  };
  for (const auto& [text, parts] : cases) {
    for (const std::string& part : parts)
      test::expect_error<InputError>([&, &text = text] { read(text); }, {part});
  }
}

TEST_F(Fleet, APlanIsScriptsAndALineARecording) {
  FleetPlan plan;
  plan.recordings = {{"one", {"it's here.bag", "--filter", "off"}}, {"two", {"b.bag"}}};
  plan.folder = "/data/night 1";
  plan.program = "/opt/penumbra";
  plan.sbatch = {"--account=lab", "--comment=two words"};
  write_fleet_plan(folder / "plan", plan);
  EXPECT_EQ(nn::read_file(folder / "plan/jobs.tsv", "text"),
            "one\t/data/night 1\t'it'\\''s here.bag' --filter off\ntwo\t/data/night 1\tb.bag\n");
  write("plan/merged/done", "the maps of these");
  write("plan/merged/log.txt", "== Monday\nresults in merged\n");
  write_fleet_plan(folder / "plan", plan);
  EXPECT_EQ(why_not_merged(folder / "plan"), "");
  plan.recordings.pop_back();
  write_fleet_plan(folder / "plan", plan);
  EXPECT_EQ(why_not_merged(folder / "plan"), "not begun");
  const std::string settings = nn::read_file(folder / "plan/settings.sh", "text");
  EXPECT_NE(settings.find("all_options=(--account=lab '--comment=two words')"), std::string::npos)
      << settings;
  for (const char* script : {"step.sh", "submit.sh", "here.sh"}) {
    const fs::perms permissions = fs::status(folder / "plan" / script).permissions();
    EXPECT_NE(permissions & fs::perms::owner_exec, fs::perms::none) << script;
  }
}

// The scripts with a program that only writes down what it is asked for.
TEST_F(Fleet, ManyMapsAreMergedByDistricts) {
  write("program", R"(#!/bin/bash
case $1 in
  slam) map=--save-map ;;
  merge) map=-o; echo "$*" >>calls ;;
esac
for ((i = 1; i < $#; ++i)); do [[ ${!i} != "${map:-}" ]] || { j=$((i + 1)); echo "$2" >"${!j}"; }; done
)");
  fs::permissions(folder / "program", fs::perms::owner_all);
  FleetPlan plan;
  for (const char* name : {"a", "b", "c", "d", "e"}) plan.recordings.push_back({name, {name}});
  plan.folder = folder;
  plan.program = folder / "program";
  plan.district_size = 2;
  write_fleet_plan(folder / "plan", plan);
  const auto run = [&](const std::string& script, const std::string& out) {
    return std::system(fmt::format("'{0}/plan/'{1} >'{0}/{2}' 2>&1", folder.string(), script, out).c_str());
  };
  ASSERT_EQ(run("here.sh", "log"), 0) << nn::read_file(folder / "log", "text");
  const std::string calls =
      "merge runs/a/recording.map runs/b/recording.map -o merged/district-1/fleet.map --out "
      "merged/district-1\n"
      "merge runs/c/recording.map runs/d/recording.map -o merged/district-2/fleet.map --out "
      "merged/district-2\n"
      "merge merged/district-1/fleet.map merged/district-2/fleet.map merged/district-3/fleet.map "
      "-o merged/fleet.map --out merged\n";
  EXPECT_EQ(nn::read_file(folder / "plan/calls", "text"), calls);
  EXPECT_EQ(why_not_merged(folder / "plan"), "");
  ASSERT_EQ(run("here.sh", "log"), 0);
  EXPECT_EQ(nn::read_file(folder / "plan/calls", "text"), calls) << "what is merged would be merged again";
  ASSERT_EQ(run("submit.sh --print", "log"), 0);
  const std::string jobs = nn::read_file(folder / "log", "text");
  EXPECT_NE(jobs.find("--array=1-3"), std::string::npos) << jobs;
  // Without the second district there is no map of all.
  fs::remove(folder / "plan/merged/district-2/done");
  write("program", "#!/bin/sh\necho error: no memory\nexit 1\n");
  fs::permissions(folder / "program", fs::perms::owner_all);
  EXPECT_NE(run("step.sh merge", "log"), 0);
  EXPECT_EQ(why_not_merged(folder / "plan"), "district-2: no memory");
  EXPECT_FALSE(fs::exists(folder / "plan/merged/fleet.map"));
  // A later plan without districts says nothing of them.
  plan.district_size = 0;
  write_fleet_plan(folder / "plan", plan);
  EXPECT_NE(run("step.sh merge", "log"), 0);
  EXPECT_FALSE(fs::exists(folder / "plan/merged/district-2"));
  EXPECT_EQ(why_not_merged(folder / "plan"), "no memory");
}

TEST_F(Fleet, AMapIsNotMergedWithItselfNorOverwritten) {
  write("a.map", "one");
  write("copy.map", "one");
  write("other.map", "two");
  fs::create_symlink(folder / "a.map", folder / "link.map");
  const auto refused = [&](const std::vector<std::string>& maps, const std::string& output,
                           const std::string& part) {
    std::string arguments;
    for (const std::string& map : maps) arguments += fmt::format("'{}' ", (folder / map).string());
    const test::ProgramResult result =
        test::run_penumbra(fmt::format("merge {} -o '{}'", arguments, (folder / output).string()));
    EXPECT_EQ(result.exit_code, 2) << result.err;
    EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
  };
  refused({"a.map", "other.map", "link.map"}, "all.map", "link.map are the same file");
  refused({"a.map", "other.map", "copy.map"}, "all.map", "copy.map are the same map");
  refused({"a.map", "other.map"}, "other.map", "other.map is one of the maps and would be overwritten");
}

TEST_F(Fleet, AManifestIsNotOverwritten) {
  write("a.bag", "");
  write("jobs.tsv", "a a.bag -\n");
  const test::ProgramResult result =
      test::run_penumbra(fmt::format("fleet plan '{0}/jobs.tsv' --out '{0}'", folder.string()));
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("a manifest that the plan does not overwrite"), std::string::npos) << result.err;
  EXPECT_EQ(nn::read_file(folder / "jobs.tsv", "text"), "a a.bag -\n");
}

TEST_F(Fleet, EachRecordingIsDoneOrSaysWhyNot) {
  write("jobs.tsv", "a\t/x\ta.bag\nb\t/x\tb.bag\nc\t/x\tc.bag\nd\t/x\td.bag\ne\t/x\te.bag\n");
  write("runs/a/done", "/x\ta.bag\n");
  write("runs/a/run.json", R"({"frames": 30, "tracked": 29, "keyframes": 4, "path_m": 12.34,
                               "ground_truth": {"ape_rmse_m": 0.0123}})");
  write("runs/b/log.txt", "== Monday\nerror: yesterday's\n== Tuesday\nerror: b.bag: <torn>\nresults in b\n");
  write("runs/c/log.txt", "== Monday\nerror: interrupted by SIGTERM after 7 frames\n");
  write("runs/c/run.json", R"({"frames": 7, "error": "interrupted by SIGTERM after 7 frames"})");
  write("runs/d/done", "/x\td.bag --frames 0:3\n");  // of an earlier plan
  write("runs/d/log.txt", "== Monday\nended with exit code 137\n");
  write("runs/d/run.json", "{\"frames\": ");
  EXPECT_EQ(fleet_table(read_fleet(folder)),
            "recording\tstate\tframes\tlocated\tkeyframes\tpath m\tAPE m\tlast words\n"
            "a\tdone\t30\t29\t4\t12.3\t0.0123\t\n"
            "b\tfailed\t-\t-\t-\t-\t-\tb.bag: <torn>\n"
            "c\tstopped\t7\t-\t-\t-\t-\tinterrupted by SIGTERM after 7 frames\n"
            "d\tnot begun\t-\t-\t-\t-\t-\t\n"
            "e\tnot begun\t-\t-\t-\t-\t-\t\n");
  const std::string page = fleet_page(folder, read_fleet(folder));
  EXPECT_NE(page.find("Done: 1 of 5 recordings"), std::string::npos);
  EXPECT_NE(page.find("&lt;torn&gt;"), std::string::npos);
  EXPECT_EQ(why_not_merged(folder), "not begun");
  write("merged/log.txt", "== Monday\nerror: b.map: another camera\nended with exit code 1\n");
  EXPECT_EQ(why_not_merged(folder), "b.map: another camera");
  write("merged/done", "a");
  EXPECT_EQ(why_not_merged(folder), "");
  test::expect_error<InputError>([&] { read_fleet(folder / "runs"); }, {"jobs.tsv"});
}

TEST(Interruption, ASignalThatComesTwiceAtOnceIsOne) {
  const Interruption interruption;
  raise(SIGTERM);
  raise(SIGTERM);  // the second would end this process
  EXPECT_TRUE(Interruption::requested());
  EXPECT_EQ(Interruption::signal_name(), "SIGTERM");
}

TEST(InterruptionDeathTest, ASecondSignalAWhileLaterEndsAtOnce) {
  EXPECT_EXIT(
      {
        const Interruption interruption;
        raise(SIGTERM);
        std::this_thread::sleep_for(std::chrono::milliseconds(400));
        raise(SIGTERM);
        exit(0);
      },
      testing::KilledBySignal(SIGTERM), "");
}

}  // namespace
}  // namespace penumbra::apps
