#include "cases/study/study_page.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cases/output/page/html.h"
#include "cases/output/page/page.h"
#include "cases/output/page/page_data.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

constexpr double kThumbnailTolerance = 3e-3;  // of the size of the picture

/// Returns the text of an attribute of an SVG file, from a position on.
std::string attribute(const std::string& svg, const std::string& name, size_t from = 0) {
  const size_t at = svg.find(" " + name + "=\"", from);
  if (at == std::string::npos) return "";
  const size_t begin = at + name.size() + 3;
  return svg.substr(begin, svg.find('"', begin) - begin);
}

/// Returns all numbers of a text, in their order.
std::vector<double> numbers_of(const std::string& text) {
  std::vector<double> out;
  for (const char *at = text.data(), *end = at + text.size(); at < end;) {
    double value = 0;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error == std::errc()) out.push_back(value);
    at = error == std::errc() ? next : at + 1;
  }
  return out;
}

/// Returns the closed lines of a path that consists of the commands M, L and Z.
std::vector<std::vector<Vec2>> rings_of_path(const std::string& path) {
  std::vector<std::vector<Vec2>> out;
  for (size_t begin = path.find('M'); begin != std::string::npos;) {
    const size_t next = path.find('M', begin + 1);
    const std::vector<double> values = numbers_of(path.substr(begin, next - begin));
    std::vector<Vec2>& ring = out.emplace_back();
    for (size_t k = 0; k + 1 < values.size(); k += 2) ring.emplace_back(values[k], values[k + 1]);
    begin = next;
  }
  return out;
}

/// Returns the small pictures of a run: one per designed body.
std::vector<std::string> pictures_of(const VariantResult& run) {
  std::vector<std::string> out;
  for (const BodyResult& body : run.bodies) {
    const std::string stem = run.bodies.size() > 1 ? "/design_" + body.body : "/design";
    out.push_back(thumbnail(text_of(run.directory + stem + ".svg")));
  }
  if (out.empty()) out.emplace_back();
  return out;
}

/// Returns the name of a run as a link to its page, if it has one.
std::string link_to(const VariantResult& run, const std::string& name, const std::string& folder) {
  const std::string page = run.directory + "/report.html";
  if (!std::filesystem::exists(page)) return escaped(name);
  return "<a href=\"" + escaped(std::filesystem::proximate(page, folder).string()) + "\">" +
         escaped(name) + "</a>";
}

/// Returns the table of the runs with their pictures.
std::string runs_table(const StudyPage& study, std::span<const VariantResult> runs,
                       const std::string& folder) {
  const bool designed =
      std::ranges::any_of(runs, [](const VariantResult& run) { return !run.bodies.empty(); });
  std::vector<HtmlColumn> columns;
  if (designed) columns.push_back({"design", "", ""});
  for (const std::string& name : study.rows.front()) columns.push_back({name, "", ""});
  std::vector<std::vector<std::string>> cells;
  size_t next = 1;
  for (const VariantResult& run : runs)
    for (const std::string& picture : pictures_of(run)) {
      if (next >= study.rows.size()) break;
      const std::vector<std::string>& row = study.rows[next++];
      std::vector<std::string>& out = cells.emplace_back();
      if (designed) out.push_back("<div class=\"design thumbnail\">" + picture + "</div>");
      for (size_t c = 0; c < row.size(); ++c)
        out.push_back(c == 0 ? link_to(run, row[c], folder) : escaped(row[c]));
    }
  return sortable_table(columns, cells);
}

}  // namespace

std::string thumbnail(const std::string& svg) {
  const std::vector<double> box = numbers_of(attribute(svg, "viewBox"));
  const std::string path = attribute(svg, "d", svg.find("<path"));
  if (box.size() != 4 || path.empty()) return "";
  const double size = std::max(box[2], box[3]);
  std::vector<Region> regions;  // rings are filled by the even-odd rule, whatever their sense
  for (const std::vector<Vec2>& ring : rings_of_path(path))
    if (ring.size() > 2) regions.push_back({thinned(ring, kThumbnailTolerance * size), {}});
  const Box frame{{box[0], box[1]}, {box[0] + box[2], box[1] + box[3]}};
  return io::outline_svg(regions, frame, 4);
}

void write_study_page(const StudyPage& study, std::span<const VariantResult> runs,
                      const std::string& path) {
  const std::string folder = std::filesystem::path(path).parent_path().string();
  const auto count = [&](const auto& condition) {
    return static_cast<int>(std::count_if(runs.begin(), runs.end(), condition));
  };
  const int done = count([](const VariantResult&run) { return run.done(); }),
            waiting = count([](const VariantResult&run) {
              return run.status == "missing" || run.status == "running";
            });
  Page page;
  page.title = study.title;
  page.refreshes = waiting > 0;
  page.good = done + waiting == static_cast<int>(runs.size());
  page.status = io::to_text(done) + " of " + io::to_text(static_cast<int>(runs.size())) +
                " runs are complete";
  page.notes = study.notes;
  nlohmann::ordered_json data = nlohmann::ordered_json::object();
  if (!study.summary.empty())
    page.sections.push_back({"summary", "Summary", text_table(study.summary)});
  page.sections.push_back({"runs", "Runs", runs_table(study, runs, folder)});
  if (!study.settings.empty())
    page.sections.push_back(
        {"settings", "Settings that differ between the runs", text_table(study.settings)});
  PageSection plots{"plots", "Plots", ""};
  for (const auto& [name, curves] : study.plots) {
    if (curves.panels.empty()) continue;
    data["plots"][name] = figure_data(curves);
    plots.html += figure(io::plot_svg(curves), name);
  }
  page.sections.push_back(std::move(plots));
  page.data = data.dump();
  io::write_file(path, page_html(page));
}

}  // namespace flexmorph::cases
