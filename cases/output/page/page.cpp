#include "cases/output/page/page.h"

#include "cases/output/page/assets.h"
#include "cases/output/page/html.h"
#include "io/encodings.h"

namespace flexmorph::cases {
namespace {

constexpr int kRefreshSeconds = 5;

std::string facts_html(const std::vector<PageFact>& facts) {
  std::string out = "<div class=\"facts\">\n";
  for (const PageFact& fact : facts)
    out += "<div class=\"fact\"><div class=\"name\">" + term(fact.name, fact.meaning) +
           "</div><div class=\"value\">" + escaped(fact.value) + "</div><div class=\"note\">" +
           escaped(fact.note) + "</div></div>\n";
  return out + "</div>\n";
}

std::string header_html(const Page& page) {
  std::string out = "<header>\n<h1>" + escaped(page.title) + "</h1>\n<p><span class=\"status " +
                    (!page.good  ? "bad"
                     : page.open ? "open"
                                 : "good") +
                    "\">" + escaped(page.status) + "</span></p>\n";
  if (!page.facts.empty()) out += facts_html(page.facts);
  for (const std::string& each : page.notes)
    if (!each.empty()) out += paragraph(each);
  for (const std::string& each : page.warnings)
    out += "<p class=\"warning\"><strong>Warning</strong> " + explained(each) + "</p>\n";
  out += "<nav>";
  for (const PageSection& section : page.sections)
    if (!section.html.empty())
      out += "<a href=\"#" + section.id + "\">" + escaped(section.heading) + "</a>";
  return out + "</nav>\n</header>\n";
}

/// Returns the scripts of the page and its data, which are compressed because browsers can inflate
/// them faster than they read long texts.
std::string scripts_html(const std::string& data) {
  std::string out = "<script type=\"application/zlib\" id=\"data\">" +
                    io::base64(io::compressed(data)) + "</script>\n<script>\n";
  out += page_asset("dygraph.js") + "\n</script>\n<script>\n\"use strict\";\n";
  for (const char* file : {"state.js", "tables.js", "plots.js", "mechanism.js", "motion.js",
                           "iterations.js", "thumbnails.js", "main.js"})
    out += page_asset(file);
  return out + "</script>\n";
}

std::string licence_html() {
  const std::string licence = page_asset("dygraph.txt");
  if (licence.empty()) return "";
  return "<details class=\"licence\"><summary>Licence of the library dygraphs, which draws the "
         "plots</summary><pre>" +
         escaped(licence) + "</pre></details>\n";
}

}  // namespace

std::string page_html(const Page& page) {
  std::string out =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n<link rel=\"icon\" href=\"data:,\">\n";
  if (page.refreshes)
    out += "<meta http-equiv=\"refresh\" content=\"" + std::to_string(kRefreshSeconds) + "\">\n";
  out += "<title>" + escaped(page.title) + "</title>\n<style>\n" + page_asset("dygraph.css") +
         page_asset("page.css") + "</style>\n</head>\n<body>\n" + header_html(page) + "<main>\n";
  for (const PageSection& section : page.sections)
    if (!section.html.empty())
      out += "<section id=\"" + section.id + "\">\n<h2>" + explained(section.heading) + "</h2>\n" +
             section.html + "</section>\n";
  out += "</main>\n";
  if (!page.data.empty()) out += licence_html() + scripts_html(page.data);
  return out + "</body>\n</html>\n";
}

}  // namespace flexmorph::cases
