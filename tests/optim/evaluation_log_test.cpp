// Shows that a killed optimizer of any kind resumes bit for bit from the log of its evaluations,
// and that a log that is incomplete, damaged or of another problem costs additional evaluations but
// never changes a result.
#include "optim/evaluation_log.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "optim/optimizer.h"
#include "tests/io/scratch.h"

namespace flexmorph::optim {
namespace {

struct Killed {};

/// Rosenbrock's function of 6 variables in pairs, with a bounded sum of variables and states near
/// the origin that cannot be solved. acceptable() depends on the value of the last evaluation.
class Valley final : public Problem {
 public:
  explicit Valley(int dies_after = 1 << 30, double shift = 0) : left_(dies_after), shift_(shift) {}
  int n_variables() const override { return 6; }
  int n_constraints() const override { return 1; }
  VectorXd lower() const override { return VectorXd::Constant(6, -2); }
  VectorXd upper() const override { return VectorXd::Constant(6, 2); }
  VectorXd start() const override { return VectorXd::Constant(6, -0.9); }
  ProblemValues evaluate(const VectorXd& x) override {
    if (left_-- == 0) throw Killed();
    ++solved;
    if (x.norm() < 0.3) throw Error::numerical("no state near the origin");
    ProblemValues out;
    out.df.setZero(6);
    for (int k = 0; k < 6; k += 2) {
      const double a = 1 - x[k] + shift_, b = x[k + 1] - x[k] * x[k];
      out.f += 0.1 * (a * a + 5 * b * b);
      out.df[k] += 0.1 * (-2 * a - 20 * b * x[k]);
      out.df[k + 1] += 0.1 * 10 * b;
    }
    out.g = VectorXd::Constant(1, (x.sum() - 4.5) / 6);
    out.dg = MatrixXd::Constant(1, 6, 1.0 / 6);
    value_ = out.f;
    return out;
  }
  bool acceptable(const VectorXd&) override { return value_ < 5; }
  int solved = 0;

 private:
  int left_;
  double shift_, value_ = 0;
};

Settings settings_of(const std::string& name) {
  Settings out;
  out.name = name;
  out.max_iterations = 25;
  out.move_limit = 0.2;
  return out;
}

/// The result of a run with all its rows, as bytes.
struct DesignView {
  std::vector<double> numbers;
  int solved = 0, known = 0;
};

DesignView run(const std::string& name, const std::string& path, int dies_after = 1 << 30,
               double shift = 0) {
  Valley valley(dies_after, shift);
  DesignView out;
  EvaluationLog log(path);
  RecordedProblem problem(valley, log);
  const auto observe = [&](const Iterate& it) {
    out.numbers.insert(out.numbers.end(), it.x->data(), it.x->data() + it.x->size());
    out.numbers.insert(out.numbers.end(), {it.response->f, it.kkt, it.violation, it.change});
    return true;
  };
  const Result result = make_optimizer(settings_of(name))->minimize(problem, observe);
  out.numbers.insert(out.numbers.end(), result.x.data(), result.x.data() + result.x.size());
  out.solved = valley.solved;
  out.known = log.n_known();
  return out;
}

void expect_same(const DesignView& a, const DesignView& b) {
  ASSERT_EQ(a.numbers.size(), b.numbers.size());
  EXPECT_EQ(std::memcmp(a.numbers.data(), b.numbers.data(), sizeof(double) * a.numbers.size()), 0);
}

class LoggedOptimizer : public ::testing::TestWithParam<std::string> {};

TEST_P(LoggedOptimizer, GoesOnBitForBit) {
  const Scratch scratch;
  const DesignView whole = run(GetParam(), scratch / "whole");
  ASSERT_GT(whole.solved, 10);
  for (const int dies_after : {0, 1, 4, 9}) {
    const std::string path = scratch / ("after_" + std::to_string(dies_after));
    // Ipopt's callbacks pass no exception on: the run ends as failed instead.
    try {
      run(GetParam(), path, dies_after);
    } catch (...) {
    }
    const DesignView again = run(GetParam(), path);
    expect_same(again, whole);
    EXPECT_EQ(again.known, dies_after);
    EXPECT_EQ(again.solved + again.known, whole.solved);
  }
  // All evaluations of a finished run are in the log.
  const DesignView once_more = run(GetParam(), scratch / "whole");
  expect_same(once_more, whole);
  EXPECT_EQ(once_more.solved, 0);
}

INSTANTIATE_TEST_SUITE_P(All, LoggedOptimizer, ::testing::ValuesIn(optimizer_names()),
                         [](const auto& info) {
                           std::string out = info.param;
                           std::replace_if(
                               out.begin(), out.end(), [](char c) { return !std::isalnum(c); },
                               '_');
                           return out;
                         });

/// A log that is cut off or damaged at some byte is used up to the last complete record and
/// rewritten completely.
TEST(EvaluationLog, EndsWhereItIsTornOrDamaged) {
  const Scratch scratch;
  const std::string path = scratch / "log";
  const DesignView whole = run("mma", path);
  const std::string bytes = contents_of(path);
  const size_t record = (bytes.size() - 24) / static_cast<size_t>(whole.solved);
  for (const size_t at : {size_t{0}, size_t{10}, size_t{24}, 24 + record / 2, 24 + 5 * record + 3,
                          bytes.size() - 1}) {
    scratch.write("log", bytes.substr(0, at));
    expect_same(run("mma", path), whole);
    EXPECT_EQ(contents_of(path), bytes) << "damaged at " << at;
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    scratch.write("log", damaged);
    const DesignView post_processed = run("mma", path);
    expect_same(post_processed, whole);
    EXPECT_LT(post_processed.known, whole.solved);
    EXPECT_EQ(contents_of(path), bytes) << "damaged at " << at;
  }
}

// Recorded evaluations are used only as long as the design is identical bit for bit; the records
// after the first other design are dropped.
TEST(EvaluationLog, KnowsOnlyTheVeryDesign) {
  const Scratch scratch;
  EvaluationLog first(scratch / "log");
  Evaluation known;
  known.x = VectorXd::Constant(2, 0.5);
  known.response.f = 3;
  known.response.df = known.x;
  known.response.g = VectorXd::Constant(1, -0.0);
  known.acceptable = false;
  first.append(known);
  known.x[1] = 0.25;
  known.failure = "no state";
  first.append(known);

  EvaluationLog again(scratch / "log");
  const auto found = again.next(VectorXd::Constant(2, 0.5));
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->response.f, 3);
  EXPECT_FALSE(found->acceptable);
  EXPECT_TRUE(std::signbit(found->response.g[0]));
  EXPECT_TRUE(again.knew_last());
  EXPECT_FALSE(again.next(VectorXd::Constant(2, std::nextafter(0.5, 1))).has_value());
  EXPECT_FALSE(again.knew_last());
  EXPECT_FALSE(again.next(known.x).has_value());  // the following records were dropped
  EvaluationLog third(scratch / "log");
  EXPECT_TRUE(third.next(VectorXd::Constant(2, 0.5)).has_value());
  EXPECT_FALSE(third.next(known.x).has_value());
}

/// Counts its calls of add().
class Calls final : public WorkCounter {
 public:
  Work work() const override { return {n_}; }
  void continue_from(const Work& work) override {
    if (!work.empty()) n_ = work.front();
  }
  void add(std::uint64_t n) { n_ += n; }

 private:
  std::uint64_t n_ = 0;
};

// A continued run has the work of the earlier run, before and after each evaluation, and adds its
// own work after the last record.
TEST(EvaluationLog, KeepsTheWork) {
  const Scratch scratch;
  const VectorXd a = VectorXd::Constant(6, -0.9), b = VectorXd::Constant(6, -0.8);
  {
    Valley valley;
    Calls calls;
    EvaluationLog log(scratch / "log");
    RecordedProblem problem(valley, log, &calls);
    calls.add(3);
    problem.evaluate(a);
    calls.add(4);
    log.append_work(calls.work());
    problem.evaluate(b);
    calls.add(5);  // the run is killed before it writes this work
  }
  Valley valley;
  Calls calls;
  EvaluationLog log(scratch / "log");
  RecordedProblem problem(valley, log, &calls);
  problem.evaluate(a);
  EXPECT_EQ(calls.work(), Work{3});
  EXPECT_EQ(log.work_after(), Work{7});
  log.append_work({100});  // not written, because the evaluation of b follows
  problem.evaluate(b);
  EXPECT_EQ(calls.work(), Work{7});
  EXPECT_TRUE(log.work_after().empty());
  calls.add(6);
  log.append_work(calls.work());
  EvaluationLog third(scratch / "log");
  ASSERT_TRUE(third.next(a) && third.next(b));
  EXPECT_EQ(third.work_after(), Work{13});
  EXPECT_EQ(valley.solved, 0);
}

TEST(EvaluationLog, ThatCannotBeWrittenSaysSo) {
  EXPECT_THROW(EvaluationLog("/proc/no_such_folder/log"), Error);
  EXPECT_THROW(EvaluationLog("/dev/full"), Error);
}

}  // namespace
}  // namespace flexmorph::optim
