// Shows that every key of case files is described, and that all outputs of these descriptions
// (terminal, reference, schema, completion, explained case) agree with the readers of case files.

#include <gtest/gtest.h>
#include <toml++/toml.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "cases/assembly/build.h"
#include "cases/check/ready.h"
#include "cases/keys/book.h"
#include "cases/keys/manual.h"
#include "cases/results/schema.h"
#include "io/case_files/case_parser.h"
#include "tests/cases/program.h"
#include "tests/support/errors.h"

namespace flexmorph::test {
namespace {

namespace fs = std::filesystem;
using cases::key_book;
using cases::KeyTable;

TEST(Keys, EveryKeyIsDescribed) {
  for (const KeyTable& table : key_book())
    for (const io::Key* key : table.keys) {
      const std::string what = table.title() + " " + key->name;
      EXPECT_FALSE(key->forms.empty()) << what;
      EXPECT_TRUE(ends(key->sentence, ".") || ends(key->sentence, "...")) << what;
      EXPECT_LE(key->sentence.size(), 100u) << what;
      EXPECT_FALSE(key->fallback && !key->absence.empty()) << what << " has two defaults";
      EXPECT_FALSE(cases::type_text(*key).empty()) << what;
      // A default must be one of the values that the key accepts.
      if (!key->fallback) continue;
      if (const auto* x = std::get_if<double>(&*key->fallback)) {
        EXPECT_TRUE(key->form(io::Form::Kind::number).quantity.holds(*x)) << what;
      }
      if (const auto* word = std::get_if<std::string>(&*key->fallback))
        for (const io::Form& form : key->forms) {
          const io::Words words = form.words();
          EXPECT_TRUE(words.empty() || std::count(words.begin(), words.end(), *word)) << what;
        }
    }
}

TEST(Keys, EveryDeclaredTableIsInTheBook) {
  for (const io::Key& key : io::all_keys())
    for (const std::string& table : key.tables)
      EXPECT_FALSE(cases::table_of_keys(table).keys.empty()) << key.name;
}

TEST(Keys, AKeyIsDeclaredOnceForEveryCondition) {
  for (const KeyTable& table : key_book())
    for (const io::Key* key : table.keys)
      for (const io::Key* other : table.keys) {
        if (key == other || key->name != other->name) continue;
        EXPECT_NE(key->condition, other->condition) << table.title() << " " << key->name;
      }
}

TEST(Keys, AWordIsExplainedOnce) {
  for (const std::string& text : {cases::keys_as_markdown(), cases::keys_as_manual()}) {
    const std::string one = "structural steel: EN 1993";
    EXPECT_NE(text.find(one), std::string::npos);
    EXPECT_EQ(text.find(one), text.rfind(one));
  }
  std::map<std::pair<std::string, io::Glossary>, std::string> seen;
  for (const KeyTable& table : key_book())
    for (const cases::WordMeanings& each : cases::meanings_of(table)) {
      EXPECT_EQ(each.words.empty(), !each.explained.empty()) << table.title() << " " << each.key;
      if (each.words.empty()) continue;
      EXPECT_TRUE(seen.emplace(std::pair(each.key, each.words), table.title()).second)
          << table.title() << " " << each.key;
    }
}

TEST(Keys, TheReferenceIsFresh) {
  const std::string text = contents_of(FLEXMORPH_CASES "/docs/keys.md");
  EXPECT_TRUE(text == cases::with_references(text))
      << "the keys have changed: build/cases/flexmorph keys --renew cases/docs/keys.md";
}

TEST(ExplainedCases, ReadBackAsTheSameText) {
  const Scratch scratch;
  // The copied cases refer to files next to them.
  for (const auto& entry : fs::directory_iterator(FLEXMORPH_CASES))
    if (entry.path().extension() == ".csv")
      fs::copy_file(entry.path(), scratch / entry.path().filename().string());
  for (const std::string& name : cases::shipped_cases()) {
    const io::CaseFile file(cases::find_case(name));
    cases::read_scene(file);
    const std::string text = file.explained();
    const io::CaseFile again(scratch.write(name + ".toml", text));
    ASSERT_NO_THROW(cases::read_scene(again)) << name;
    EXPECT_EQ(again.explained(), text) << name;
    EXPECT_TRUE(contains(text, "\nrho_inf = ") || contains(text, "[domain]") ||
                contains(text, "[static]"))
        << name;
  }
}

TEST(ExplainedCases, RunAsTheCaseItself) {
  const Scratch scratch;
  const Words changes = {"time.end=0.02", "optimizer.max_iterations=2"};
  const std::string plain = scratch / "plain", explained = scratch / "explained",
                    again = scratch / "again";
  ASSERT_EQ(flexmorph(scratch, short_run(plain, changes)).code, kTooFew);
  Words words = short_run(explained, changes);
  words.emplace_back("--explain");
  ASSERT_EQ(flexmorph(scratch, words).code, kTooFew);
  const std::string kept = explained + "/case.toml";
  EXPECT_TRUE(contains(contents_of(kept), "kkt_tolerance = 1e-04 "));
  ASSERT_EQ(flexmorph(scratch, {"run", kept, "-o", again}).code, kTooFew);
  for (const char* file : {"motion.csv", "components.csv", "case.toml"})
    EXPECT_EQ(contents_of(again + "/" + file), contents_of(explained + "/" + file)) << file;
  for (const char* file : {"motion.csv", "components.csv"})
    EXPECT_EQ(contents_of(again + "/" + file), contents_of(plain + "/" + file)) << file;
  EXPECT_EQ(flexmorph(scratch, {"check", kept, "--explain"}).out, contents_of(kept));
}

TEST(KeysCommand, ShowsATableOrAllOfThem) {
  const Scratch scratch;
  const Ended one = flexmorph(scratch, {"keys", "time"});
  EXPECT_EQ(one.code, 0);
  EXPECT_TRUE(starts(one.out, "[time]: "));
  for (const char* part : {"  end ", "number > 0 [s]", "required", "0.8", "\"adaptive\""})
    EXPECT_TRUE(contains(one.out, part)) << one.out;

  for (const std::string& line : lines_of(one.out)) EXPECT_LE(line.size(), 100u) << line;
  const Ended all = flexmorph(scratch, {"keys"});
  EXPECT_TRUE(contains(all.out, one.out));
  EXPECT_TRUE(contains(all.out, "\n[[design.solid]], [[design.void]]: "));
  EXPECT_EQ(flexmorph(scratch, {"keys", "--schema"}).out, cases::keys_as_schema());
  EXPECT_EQ(flexmorph(scratch, {"keys", "--markdown"}).out, cases::keys_as_markdown());
}

TEST(KeysCommand, FindsKeysByAWord) {
  const Scratch scratch;
  const Ended found = flexmorph(scratch, {"keys", "Poisson"});
  EXPECT_EQ(found.code, 0);
  EXPECT_TRUE(testing::mentions_all(found.out, {"[[body]]", "  poisson_ratio ", "[domain]"}));
  EXPECT_FALSE(contains(found.out, "  thickness "));
  Ended materials = flexmorph(scratch, {"keys", "material"});
  // 80 columns, and names of tables that are longer than their column.
  for (const std::string& line : lines_of(materials.out)) EXPECT_LE(line.size(), 80u) << line;
  std::istringstream words(std::exchange(materials.out, ""));
  for (std::string word; words >> word;) materials.out += word + " ";
  EXPECT_TRUE(testing::mentions_all(materials.out,
                                    {"material = \"steel\": density 7850 kg/m^3", "EN 1993-1-1",
                                     "material = \"aluminium\"", "EN 1999-1-1"}));
  // Each material is explained once; the other tables with this key name the table that has it.
  EXPECT_EQ(materials.out.find("material = \"steel\""),
            materials.out.rfind("material = \"steel\""));
  EXPECT_TRUE(contains(materials.out, "material: the words are explained under [[body]]."));
  // The whole reference says what a number may be.
  EXPECT_TRUE(testing::mentions_all(lines_of(flexmorph(scratch, {"keys"}).out)[0] + " " +
                                        lines_of(flexmorph(scratch, {"keys"}).out)[1],
                                    {"[constants]", "\"12 mm\""}));
}

TEST(KeysCommand, NamesTheTableThatWasMeant) {
  const Scratch scratch;
  const Ended ended = flexmorph(scratch, {"keys", "optimiser"});
  EXPECT_EQ(ended.code, 2);
  EXPECT_TRUE(testing::mentions_all(ended.err, {"'optimiser'", "'optimizer'"}));
  EXPECT_EQ(flexmorph(scratch, {"keys", "--renew", FLEXMORPH_SHORT_CASE}).code, 2);
}

class Completion : public ::testing::Test {
 protected:
  /// Returns the completions that bash offers at the end of `line`; for a word with "=" only the
  /// text after it.
  Words offers(const std::string& line) {
    const std::string out = scratch_ / "offers";
    scratch_.write("ask.sh", "source <(" FLEXMORPH_PROGRAM
                             " completion bash)\n"
                             "flexmorph() { " FLEXMORPH_PROGRAM
                             " \"$@\"; }\n"
                             "COMP_LINE='" +
                                 line +
                                 "'\nCOMP_POINT=${#COMP_LINE}\n"
                                 "COMP_WORDS=($COMP_LINE)\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n"
                                 "_flexmorph\nprintf '%s\\n' \"${COMPREPLY[@]}\" > '" +
                                 out + "'\n");
    const std::string command = "bash '" + (scratch_ / "ask.sh") + "'";
    EXPECT_EQ(testing::run_shell(command).code, 0);
    return lines_of(contents_of(out));
  }
  Scratch scratch_;
};

bool among(const Words& words, const std::string& wanted) {
  return std::count(words.begin(), words.end(), wanted) == 1;
}

TEST_F(Completion, OffersWhatMayFollow) {
  const Words commands = offers("flexmorph ");
  for (const char* each : {"run", "check", "keys", "completion", "stability"})
    EXPECT_TRUE(among(commands, each)) << each;
  EXPECT_EQ(offers("flexmorph comp"), (Words{"compare", "completion"}));
  EXPECT_EQ(offers("flexmorph run four"), Words{"four_bar"});
  EXPECT_EQ(offers("flexmorph run four_bar --exp"), Words{"--explain"});
  EXPECT_EQ(offers("flexmorph keys body.f"), Words{"body.flow"});
  EXPECT_EQ(offers("flexmorph verify four"), Words{"four_bar"});
  const std::string part = scratch_.write("arm.dxf", "");
  EXPECT_EQ(offers("flexmorph verify four_bar --part arm=" + part.substr(0, part.size() - 3)),
            Words{part});
  EXPECT_EQ(offers("flexmorph completion z"), Words{"zsh"});
}

TEST_F(Completion, OffersKeysAndTheirWords) {
  EXPECT_EQ(offers("flexmorph run four_bar --set optimizer.max"),
            (Words{"optimizer.max_iterations=", "optimizer.max_solves="}));
  // Readline breaks words at "=" and replaces only the text after it.
  EXPECT_EQ(offers("flexmorph run four_bar --set optimizer.name=ip"), Words{"ipopt"});
  EXPECT_EQ(offers("flexmorph check x.toml --set output.vtk="), (Words{"true", "false"}));
  EXPECT_EQ(offers("flexmorph sweep four_bar --vary time.start=hub"), Words{"hub_at_rest"});
}

TEST_F(Completion, AnotherShellIsBadInput) {
  EXPECT_EQ(flexmorph(scratch_, {"completion", "fish"}).code, 2);
  EXPECT_TRUE(contains(flexmorph(scratch_, {"completion", "zsh"}).out, "compdef _flexmorph"));
}

}  // namespace
}  // namespace flexmorph::test
