// Shows that the values of case files are read as written, and that every error names file, line,
// key, value and the allowed values, or the option of the command line that set the value.
#include "io/case_files/case_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "io/case_files/case_document.h"
#include "io/case_files/case_parser.h"
#include "tests/io/scratch.h"

namespace flexmorph::io {
namespace {

constexpr const char* kText = R"(title = "a plate"   # line 1

[time]
end = 1
step = 1e-3

[[body]]
name = "plate"
thickness = -0.002
elements = [10, 2]
terms = ["inertia", "inertia"]
flow = { speed = 0.1 }

[[body]]
name = "arm"
thickness = "thin"
flag = 1
when = 2020-01-01
)";

using Overrides = std::vector<std::string>;

class CaseFiles : public ::testing::Test {
 protected:
  /// Returns the message of the error that `read` causes, without the folder of the test.
  std::string error(const std::function<void(const Table&)>& read, const Overrides& changes = {},
                    const std::string& text = kText) {
    try {
      const CaseFile file(scratch_.write("plate.toml", text), changes);
      read(file.root());
      file.finish();
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), Error::Kind::input);
      std::string message = e.what();
      for (size_t at; (at = message.find(scratch_ / "")) != std::string::npos;)
        message.erase(at, (scratch_ / "").size());
      return message;
    }
    return "";
  }
  Scratch scratch_;
};

// Keys for these tests only, which are not in the list of all keys.
Key quick(const std::string& table, const std::string& name) {
  Key out;
  out.tables = {table};
  out.name = name;
  return out;
}
Key a_number(const std::string& table, const std::string& name, const Quantity& quantity) {
  return quick(table, name).number(quantity);
}
Key a_text(const std::string& name, const std::string& noun) { return quick("", name).text(noun); }
Key a_table(const std::string& name) { return quick("", name).table(); }

const Key kTitle = a_text("title", "a title");
const Key kTime = a_table("time"), kEsl = a_table("esl"), kVerify = a_table("verify");
const Key kBody = quick("", "body").tables_of();
const Key kThickness = a_number("body", "thickness", positive("a thickness", "m"));
const Key kFlow = quick("body", "flow").table();
const Key kSpeed = a_number("body.flow", "speed", any_number("a speed"));
const Key kCounts = quick("body", "elements").integers("a count", 1, 100, 2, 2);
const Key kAnyCounts = quick("body", "elements").numbers(positive("a count"));

Table plate(const Table& root) { return root.tables(kBody).at(0); }
Table arm(const Table& root) { return root.tables(kBody).at(1); }
void touch_all(const Table& table) {
  for (const std::string& key : table.keys()) table.has(quick("", key));
}

TEST_F(CaseFiles, OptionsMayOmitTheQuotesOfAWord) {
  for (const char* word : {"motion", "plate.tip_deflection", "energy.strain", "drive-2.csv"})
    EXPECT_EQ(parse_option(word, "--set a").text, word);
  for (const char* wrong : {"a b", "a,b", "..", "a=b"})
    EXPECT_THROW(parse_option(wrong, "--set a"), Error) << wrong;
}

TEST_F(CaseFiles, ValuesArriveAsWritten) {
  const CaseFile file(scratch_.write("plate.toml", kText));
  const Table time = file.root().table(kTime);
  EXPECT_EQ(time.number(a_number("time", "end", positive("an end", "s"))),
            1.0);  // a whole number is a number
  EXPECT_EQ(time.number(a_number("time", "step", positive("a step", "s"))), 1e-3);
  EXPECT_EQ(time.number(a_number("time", "rho_inf", any_number("it")), 0.8), 0.8);
  EXPECT_EQ(file.root().string(kTitle), "a plate");
  EXPECT_EQ(plate(file.root()).integers(kCounts), (std::vector<int>{10, 2}));
  EXPECT_EQ(plate(file.root()).numbers(kAnyCounts), (std::vector<double>{10, 2}));
  EXPECT_EQ(plate(file.root()).table(kFlow).path(), "body.plate.flow");
  EXPECT_TRUE(file.root().tables(quick("", "joint").tables_of()).empty());
  EXPECT_EQ(file.text(), kText);
}

TEST_F(CaseFiles, ListsOfLists) {
  const std::string text =
      "table = [[0, 1.5],\n         [1, -2]]\nnames = [\"a\", \"b\"]\nmixed = [1, \"b\"]\n";
  const CaseFile file(scratch_.write("plate.toml", text));
  const Table root = file.root();
  EXPECT_EQ(root.rows(quick("", "table").rows(any_number("it"), 2)),
            (std::vector<std::vector<double>>{{0, 1.5}, {1, -2}}));
  EXPECT_TRUE(root.is_list_of_strings(quick("", "names")));
  for (const char* key : {"table", "mixed", "none"})
    EXPECT_FALSE(root.is_list_of_strings(quick("", key)));
  const auto rows = [&](const char* key, const Quantity& each, int columns) {
    return error([&](const Table& t) { t.rows(quick("", key).rows(each, columns)); }, {}, text);
  };
  const std::string location = "plate.toml:1:9: table = [[0, 1.5], [1, -2]]: ";
  EXPECT_TRUE(says(rows("table", any_number("it"), 3), location, {"lists", "3", "it", "finite"}));
  EXPECT_TRUE(says(rows("table", not_negative("it", "m"), 2), location,
                   {"lists", "2", "it", "negative", "[m]"}));
  EXPECT_TRUE(says(rows("mixed", any_number("it"), 1),
                   "plate.toml:4:9: mixed = [1, \"b\"]: ", {"lists", "1", "it", "finite"}));
}

// Paths in a case are relative to its folder; paths of the command line are relative to the working
// folder.
TEST_F(CaseFiles, FilesLieBesideTheCase) {
  const std::string path = scratch_.write("plate.toml", kText),
                    other = scratch_.write("other.toml", "title = '/elsewhere.csv'\n");
  EXPECT_EQ(CaseFile(path).root().path_of(kTitle), scratch_ / "a plate");
  EXPECT_EQ(CaseFile(other).root().path_of(kTitle), "/elsewhere.csv");
  const Overrides typed = {"title='motion.csv'"};
  EXPECT_EQ(CaseFile(path, typed).root().path_of(kTitle), "motion.csv");
}

TEST_F(CaseFiles, RangeIsSaidWithUnit) {
  const auto thickness = [](const Quantity& q) {
    return [q](const Table& root) { plate(root).number(a_number("body", "thickness", q)); };
  };
  const std::string start = "plate.toml:9:13: body.plate.thickness = -0.002: ";
  const auto refused = [&](const Quantity& q, const std::vector<std::string>& parts) {
    return says(error(thickness(q)), start, parts);
  };
  EXPECT_TRUE(refused(positive("a thickness", "m"), {"a thickness", "positive", "[m]"}));
  EXPECT_TRUE(refused(between("a share", "", 0, 1), {"a share", "0", "1"}));
  EXPECT_TRUE(refused({.noun = "it", .lower = 2, .lower_open = true}, {"it", "above", "2"}));
  EXPECT_TRUE(refused({.noun = "it", .upper = -1}, {"it", "at most", "-1"}));
}

TEST_F(CaseFiles, WrongTypesAreSaid) {
  EXPECT_TRUE(
      says(error([](const Table& root) { arm(root).number(kThickness.called("a size")); }),
           "plate.toml:16:13: body.arm.thickness = \"thin\": ", {"a size", "positive", "[m]"}));
  EXPECT_TRUE(
      says(error([](const Table& root) { arm(root).boolean(quick("body", "flag").boolean()); }),
           "plate.toml:17:8: body.arm.flag = 1: ", {"true", "false"}));
  EXPECT_TRUE(says(error([](const Table& root) {
                     root.table(kTime).integer(quick("time", "step").integer("a count", 1, 9));
                   }),
                   "plate.toml:5:8: time.step = 1e-3: ", {"a count", "whole", "1", "9"}));
  EXPECT_TRUE(says(error([](const Table& root) { root.table(a_table("title")); }),
                   "plate.toml:1:9: title = \"a plate\": ", {"[title]", "table"}));
  EXPECT_TRUE(says(error([](const Table& root) { root.tables(quick("", "time").tables_of()); }),
                   "plate.toml:3:1: [time]: ", {"[[time]]"}));
  EXPECT_TRUE(says(
      error([](const Table& root) { plate(root).numbers(kAnyCounts.counted(3)); }),
      "plate.toml:10:12: body.plate.elements = [10, 2]: ", {"list", "3", "a count", "positive"}));
  EXPECT_TRUE(starts(
      error([](const Table& root) { arm(root).string(quick("body", "when").text("a date")); }),
      "plate.toml:18:8: body.arm.when = 2020-01-01: "));
}

TEST_F(CaseFiles, NotANumberAndInfinityAreRefused) {
  for (const char* value : {"nan", "inf", "-inf", "+inf"}) {
    const std::string option = std::string("time.end=") + value;
    EXPECT_TRUE(says(error(
                         [](const Table& root) {
                           root.table(kTime).number(a_number("time", "end", any_number("it")));
                         },
                         {option}),
                     "--set " + option + ": ", {"it", "finite"}));
  }
}

TEST_F(CaseFiles, ChoicesListWhatIsAllowed) {
  const std::vector<std::string> terms = {"inertia", "membrane"};
  const auto choose = [&](const Table& root) {
    root.choice(quick("", "title").name_of("a title"), terms);
  };
  EXPECT_TRUE(says(error(choose), "plate.toml:1:9: title = \"a plate\": ",
                   {"a title", "'inertia'", "'membrane'"}));
  // The suggestion follows the words that are allowed.
  EXPECT_TRUE(says(error(choose, {"title=inertai"}),
                   "--set title=inertai: ", {"a title", "'inertia'", "'membrane'", "'inertia'"}));
  EXPECT_TRUE(says(error([&](const Table& root) {
                     plate(root).choices(quick("body", "terms").names_of("a term"), terms);
                   }),
                   "plate.toml:11:9: body.plate.terms = [\"inertia\", \"inertia\"]: ",
                   {"a term", "'inertia'", "'membrane'", "once"}));
}

TEST_F(CaseFiles, MissingKeysAreNamed) {
  EXPECT_TRUE(
      says(error([](const Table& root) {
             plate(root).number(a_number("body", "width", positive("a width", "m")));
           }),
           "plate.toml:7:1: ", {"body.plate.width", "missing", "a width", "positive", "[m]"}));
  EXPECT_TRUE(says(error([](const Table& root) { root.table(kEsl); }),
                   "plate.toml:1:1: ", {"esl", "missing", "[esl]", "table"}));
  // A misspelled key is reported instead of the missing one.
  EXPECT_TRUE(says(error([](const Table& root) {
                     root.table(kTime).number(a_number("time", "steps", positive("it")));
                   }),
                   "plate.toml:5:8: time.step = 1e-3: ", {"unknown", "'steps'"}));
}

TEST_F(CaseFiles, UnknownKeysAreErrors) {
  EXPECT_TRUE(says(error([](const Table& root) {
                     touch_all(root);
                     root.table(kTime).number(a_number("time", "end", positive("it")));
                     root.table(kTime).has(quick("time", "stepp"));
                   }),
                   "plate.toml:5:8: time.step = 1e-3: ", {"unknown", "'stepp'"}));
  EXPECT_TRUE(says(error([](const Table& root) {
                     root.has(kTitle);
                     root.has(kBody);
                   }),
                   "plate.toml:3:1: [time]: ", {"unknown", "body", "title"}));
  EXPECT_EQ(error(touch_all), "");
  EXPECT_EQ(error(touch_all, {"foo=1"}), "");
  EXPECT_TRUE(says(error(
                       [](const Table& root) {
                         for (auto k : {"title", "time", "body"}) root.has(quick("", k));
                       },
                       {"bdoy.x=1"}),
                   "--set bdoy.x=1: [bdoy]: ", {"unknown", "'body'"}));
}

TEST_F(CaseFiles, UnknownKeysFillOneScreenAtMost) {
  std::vector<std::string> changes;
  for (int k = 0; k < 100; ++k) changes.push_back("junk" + std::to_string(k) + "=1");
  const std::string words = error(
      [](const Table& root) {
        for (auto k : {"title", "time", "body"}) root.has(quick("", k));
      },
      changes);
  EXPECT_EQ(std::count(words.begin(), words.end(), '\n'), 19);
  EXPECT_TRUE(contains(words.substr(words.rfind('\n') + 1), "81")) << words;
}

// Columns count characters like editors do, not bytes.
TEST_F(CaseFiles, ColumnsCountCharacters) {
  const auto read = [](const Table& root) { root.number(a_number("", "a", positive("it"))); };
  EXPECT_TRUE(
      says(error(read, {}, "\n  a = -1\n"), "plate.toml:2:7: a = -1: ", {"it", "positive"}));
  EXPECT_TRUE(starts(error(read, {}, "b = { c = \"äöü\" }\na = \"ä\"\n"), "plate.toml:2:5: a"));
}

// An entry is labelled by its name if the name is a word and unique, else by its number.
TEST_F(CaseFiles, EntriesAreLabelled) {
  std::string text;
  for (const char* entry : {"name = \"a\"", "body = \"b\"", "name = \"b\"", "name = \"c d\"",
                            "x = 1", "name = \"e\"\nbody = \"f\"", "name = 7\nbody = \"g\""})
    text += std::string("[[list]]\n") + entry + "\n";
  const CaseDocument document(scratch_.write("plate.toml", text + "[[one]]\nname = \"a\"\n"));
  const CaseNode &list = *document.root.find("list"), &one = *document.root.find("one");
  EXPECT_EQ(entry_labels(list), (std::vector<std::string>{"a", "1", "2", "3", "4", "e", "g"}));
  EXPECT_EQ(entry_paths(list, "list")[5], "list.e");
  EXPECT_EQ(entry_paths(one, "one"), std::vector<std::string>{"one"});
}

// A path is located in the file; a key that is not given is located at its table.
TEST_F(CaseFiles, PathsAreFound) {
  const CaseFile file(scratch_.write("plate.toml", kText), Overrides{"time.end=2"});
  const std::string start = (scratch_ / "plate.toml") + ":";
  EXPECT_EQ(file.where("body.plate.thickness"), start + "9:13: body.plate.thickness = -0.002");
  EXPECT_EQ(file.where("body.0.thickness"), start + "9:13: body.plate.thickness = -0.002");
  EXPECT_EQ(file.where("body.1"), start + "14:1: [body.arm]");
  EXPECT_EQ(file.where("body.nobody.thickness"), start + "7:1: [[body]]");
  EXPECT_EQ(file.where("body.plate.flow.speed"), start + "12:18: body.plate.flow.speed = 0.1");
  EXPECT_EQ(file.where("time.end"), "--set time.end=2");
  EXPECT_EQ(file.where("time.rho_inf"), start + "3:1: [time]");
  file.root().table(kTime).number(a_number("time", "rho_inf", any_number("it")), 0.8);
  EXPECT_TRUE(says(file.where("time.rho_inf"), start + "3:1: time.rho_inf = 0.8 ", {"not given"}));
  EXPECT_EQ(file.where("verify.mesh"), start + "1:1");
  EXPECT_TRUE(file.gives("time.step"));
  EXPECT_FALSE(file.gives("time.rho_inf"));
}

TEST_F(CaseFiles, FilesThatAreNone) {
  EXPECT_THROW(CaseFile(scratch_ / "absent.toml"), Error);
  try {
    CaseFile file(scratch_ / "absent.toml");
  } catch (const Error& e) {
    EXPECT_TRUE(says(e.what(), scratch_ / "absent.toml: ", {"no such"}));
  }
  try {
    CaseFile file(scratch_ / "");
    FAIL();
  } catch (const Error& e) {
    EXPECT_TRUE(says(e.what(), scratch_ / "", {"directory"}));
  }
  EXPECT_TRUE(says(error(touch_all, {}, "a = 1\nb = = 2\n"), "plate.toml:2:5: ", {"TOML"}));
  EXPECT_TRUE(says(error(touch_all, {}, "a = 1\na = 2\n"), "plate.toml:2:5: ", {"TOML"}));
  EXPECT_TRUE(says(error(touch_all, {}, "a = \"\xff\"\n"), "plate.toml:1:5: ", {"TOML"}));
  EXPECT_EQ(error(touch_all, {}, ""), "");
}

TEST_F(CaseFiles, OverridesReachEveryLocation) {
  const auto number = [&](const Overrides& changes, auto find) {
    const CaseFile file(scratch_.write("plate.toml", kText), changes);
    return find(file.root()).number(kThickness);
  };
  EXPECT_EQ(number({"body.plate.thickness=7e-4"}, plate), 7e-4);
  EXPECT_EQ(number({"body.1.thickness=2"}, arm), 2);
  EXPECT_EQ(number({"body.arm.thickness = 2", "body.1.thickness=3"}, arm), 3);

  const CaseFile file(
      scratch_.write("one.toml", "[[body]]\nname = 'plate'\n"),
      Overrides{"body.flow.speed=0.5", "esl.definition=frozen", "gravity=[0, -9.81]"});
  EXPECT_EQ(plate(file.root()).table(kFlow).number(kSpeed), 0.5);
  EXPECT_EQ(file.root().table(kEsl).string(quick("esl", "definition").text("it")), "frozen");
  EXPECT_EQ(file.root().numbers(quick("", "gravity").numbers(any_number("it"), 2, 2)),
            (std::vector<double>{0, -9.81}));
}

TEST_F(CaseFiles, OverridesAreLocatedByTheirOption) {
  const auto set = [&](const std::string& option, const std::vector<std::string>& parts,
                       const std::function<void(const Table&)>& read = touch_all) {
    return says(error(read, {option}), "--set " + option + ": ", parts);
  };
  EXPECT_TRUE(set("body.plate.thickness=-1", {"it", "positive", "[m]"},
                  [](const Table& root) { plate(root).number(kThickness.called("it")); }));
  EXPECT_TRUE(set("body.thickness=1", {"body", "2", "plate", "arm"}));
  EXPECT_TRUE(set("time.end", {"KEY=VALUE"}));
  EXPECT_TRUE(set("time.end.x=1", {"time.end", "table"}));
  EXPECT_TRUE(set("a..b=1", {"KEY", "dots"}));
  EXPECT_TRUE(set("a=1 2", {"VALUE", "TOML"}));
  EXPECT_TRUE(set("verify.step=1", {"verify.mesh", "missing", "it", "whole", "1", "2"},
                  [](const Table& root) {
                    root.table(kVerify).integer(quick("verify", "mesh").integer("it", 1, 2));
                  }));
}

TEST_F(CaseFiles, OverridesWithoutAValueTakeKeysAway) {
  const CaseFile file(scratch_.write("plate.toml", kText),
                      Overrides{"verify=", "body.arm.thickness=", "nowhere.at.all="});
  EXPECT_FALSE(file.root().has(kVerify));
  EXPECT_FALSE(arm(file.root()).has(kThickness));
  EXPECT_EQ(plate(file.root()).number(a_number("body", "thickness", any_number("it"))), -0.002);
  EXPECT_FALSE(file.root().has(a_table("nowhere")));
  const CaseFile again(scratch_.write("again.toml", file.text()));
  EXPECT_FALSE(again.root().has(kVerify));
  EXPECT_TRUE(again.root().has(kTime));

  const CaseFile less(scratch_.write("less.toml", kText), Overrides{"body.plate="});
  EXPECT_EQ(less.root().tables(kBody).size(), 1u);
  EXPECT_TRUE(less.root().tables(kBody).at(0).has(quick("body", "when")));
  const CaseFile none(scratch_.write("none.toml", kText), Overrides{"body.1=", "body.plate="});
  EXPECT_FALSE(none.root().has(kBody));
}

// The effective case is again a case, with the changes in it and every other value unchanged.
TEST_F(CaseFiles, EffectiveTextReadsBack) {
  const CaseFile changed(
      scratch_.write("plate.toml", kText),
      Overrides{"body.arm.thickness=0.1", "verify.step=1e-4", "title=\"a \\\"new\\\" one\""});
  const CaseFile again(scratch_.write("again.toml", changed.text()));
  const Table root = again.root();
  EXPECT_EQ(root.string(kTitle), "a \"new\" one");
  EXPECT_EQ(arm(root).number(kThickness), 0.1);
  EXPECT_EQ(plate(root).number(a_number("body", "thickness", any_number("it"))), -0.002);
  EXPECT_EQ(plate(root).table(kFlow).number(kSpeed), 0.1);
  EXPECT_EQ(root.table(kVerify).number(a_number("verify", "step", any_number("it"))), 1e-4);
  EXPECT_EQ(again.text(), changed.text());
  EXPECT_EQ(root.keys(), (std::vector<std::string>{"title", "time", "body", "verify"}));
}

TEST_F(CaseFiles, NumbersDoNotDependOnTheLocale) {
  const CommaLocale comma;
  const CaseFile file(scratch_.write("plate.toml", "a = 1234.5\nb = 10000\n"), Overrides{"c=0.25"});
  EXPECT_EQ(file.root().number(a_number("", "a", any_number("it"))), 1234.5);
  EXPECT_EQ(file.root().number(a_number("", "c", any_number("it"))), 0.25);
  EXPECT_TRUE(contains(file.text(), "a = 1234.5\nb = 10000\nc = 0.25\n"));
  EXPECT_TRUE(
      says(error([](const Table& root) { root.integer(quick("", "a").integer("it", 1, 20000)); },
                 {}, "\n\na = 1234.5\n"),
           "plate.toml:3:5: a = 1234.5: ", {"whole", "20000"}));
}

}  // namespace
}  // namespace flexmorph::io
