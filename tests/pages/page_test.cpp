#include "cases/output/page/page.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "cases/output/page/html.h"
#include "cases/output/page/page_data.h"
#include "tests/cases/run_json.h"

namespace flexmorph::cases {
namespace {

constexpr int kIterations = 1200, kComponents = 96;

/// Returns the history of a design whose components move less and less.
RunFolder::History long_history() {
  RunFolder::History out;
  out.body = "plate";
  out.min_half_thickness = 0.004;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> change(-1, 1);
  std::vector<double> now;
  for (int k = 0; k < kComponents * Component::kParameters; ++k)
    now.push_back(0.5 + change(random));
  for (int i = 0; i < kIterations; ++i) {
    for (double& p : now) p += 0.02 * std::exp(-i / 200.0) * change(random);
    out.components.emplace_back(now.begin(), now.end());
    out.row.push_back(i + 1);
    out.compliance.push_back(1 + std::exp(-i / 100.0));
    out.volume.push_back(0.4);
    out.kkt.push_back(std::exp(-i / 100.0));
  }
  return out;
}

const Box kFrame{{0, -0.5}, {2, 0.5}};

TEST(PageData, HistoriesGiveBackTheirComponents) {
  const RunFolder::History history = long_history();
  const nlohmann::ordered_json data = history_data(history, kFrame);
  ASSERT_EQ(data["components"].size(), size_t(kIterations));
  const double unit = data["unit"].get<double>(), turn = data["angle_unit"].get<double>();
  EXPECT_LE(unit, 2e-4 * 2);
  std::vector<double> now;
  for (size_t i = 0; i < data["components"].size(); ++i) {
    const auto entry = data["components"][i].get<std::vector<double>>();
    const std::vector<float>& expected = history.components[i];
    ASSERT_EQ(entry.size(), expected.size() + 1);
    if (entry[0] == 1) now.assign(expected.size(), 0);
    for (size_t k = 0; k < expected.size(); ++k) {
      now[k] += entry[k + 1];
      const double size = k % 7 == 3 ? turn : unit;
      EXPECT_NEAR(now[k] * size, double(expected[k]), 0.51 * size);
    }
  }
}

TEST(PageData, UnknownIterationsAreEmpty) {
  RunFolder::History history = long_history();
  for (size_t i = 0; i < 10; ++i) history.components[i].clear();
  const nlohmann::ordered_json data = history_data(history, kFrame);
  EXPECT_TRUE(data["components"][9].empty());
  EXPECT_EQ(data["components"][10][0], 1);
  EXPECT_EQ(data["components"][11][0], 0);
}

TEST(Page, Of1200IterationsIsSmall) {
  nlohmann::ordered_json data;
  data["iterations"].push_back(history_data(long_history(), kFrame));
  Page page;
  page.title = "A long run";
  page.data = data.dump();
  EXPECT_LT(page_html(page).size(), 3'000'000u);
}

TEST(PageData, LongCurvesKeepTheirExtremes) {
  io::Figure figure;
  io::Panel& panel = figure.panels.emplace_back();
  io::Curve& curve = panel.curves.emplace_back();
  for (int i = 0; i < 100'000; ++i) {
    curve.x.push_back(i);
    curve.y.push_back(std::sin(0.37 * i));
  }
  curve.y[51'234] = 7;
  curve.y[77'777] = -9;
  const nlohmann::ordered_json data = figure_data(figure)["panels"][0]["curves"][0];
  const auto x = data["x"].get<std::vector<double>>(), y = data["y"].get<std::vector<double>>();
  EXPECT_LE(x.size(), 2100u);
  EXPECT_TRUE(std::is_sorted(x.begin(), x.end()));
  EXPECT_EQ(*std::max_element(y.begin(), y.end()), 7);
  EXPECT_EQ(*std::min_element(y.begin(), y.end()), -9);
  EXPECT_EQ(x[static_cast<size_t>(std::max_element(y.begin(), y.end()) - y.begin())], 51'234);
}

TEST(PageData, OutlinesAreWithinTheirTolerance) {
  Region disc;
  for (int k = 0; k < 2000; ++k)
    disc.outer.emplace_back(0.3 * std::cos(2e-3 * M_PI / 2 * 2 * k),
                            0.3 * std::sin(2e-3 * M_PI / 2 * 2 * k));
  disc.outer.resize(1000);
  const nlohmann::ordered_json data = outline_data(std::vector<Region>{disc}, kFrame);
  const auto ring = data["rings"][0].get<std::vector<double>>();
  EXPECT_LT(ring.size(), 200u);
  const double unit = data["unit"].get<double>();
  for (size_t k = 0; k + 3 < ring.size(); k += 2) {
    const Vec2 a(ring[k] * unit, ring[k + 1] * unit), b(ring[k + 2] * unit, ring[k + 3] * unit);
    EXPECT_NEAR(a.norm(), 0.3, 2 * unit);
    EXPECT_GT((0.5 * (a + b)).norm(), 0.3 - 1.1e-3 * 2);
  }
}

TEST(Html, TermsAreExplainedOnce) {
  const std::string html = explained("The compliance <&> is a compliance of components.");
  EXPECT_NE(html.find("&lt;&amp;&gt;"), std::string::npos);
  const std::string mark = "class=\"term\"";
  EXPECT_NE(html.find(mark), std::string::npos);
  EXPECT_EQ(html.find(">compliance</span>"), html.rfind(">compliance</span>"));
  EXPECT_NE(html.find(">components</span>"), std::string::npos);
  EXPECT_EQ(explained("incompliancely"), "incompliancely");
}

TEST(Html, TablesOfQuantitiesLeaveOutRowsWithoutValues) {
  const std::string html = quantity_table({"a"}, {{{"first_number", "m", "It is first."}, {"1.5"}},
                                                  {{"second_number", "m", "It is second."}, {""}}});
  EXPECT_NE(html.find("first number"), std::string::npos);
  EXPECT_NE(html.find("It is first."), std::string::npos);
  EXPECT_NE(html.find("<td class=\"number\">1.5</td>"), std::string::npos);
  EXPECT_EQ(html.find("second number"), std::string::npos);
}

TEST(Page, EscapesTextAndLeavesOutEmptySections) {
  Page page;
  page.title = "A \"plate\" <b>";
  page.sections = {{"first", "First & best", "<p>words</p>"}, {"second", "Second", ""}};
  const std::string html = page_html(page);
  EXPECT_NE(html.find("<title>A &quot;plate&quot; &lt;b&gt;</title>"), std::string::npos);
  EXPECT_NE(html.find("First &amp; best</h2>"), std::string::npos);
  EXPECT_EQ(html.find("Second"), std::string::npos);
  EXPECT_EQ(html.find("http-equiv=\"refresh\""), std::string::npos);
  page.refreshes = true;
  EXPECT_NE(page_html(page).find("http-equiv=\"refresh\""), std::string::npos);
}

}  // namespace
}  // namespace flexmorph::cases
