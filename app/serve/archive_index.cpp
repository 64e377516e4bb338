#include "app/serve/archive_index.h"

#include "app/base/text.h"
#include "net/serve/http_range.h"
#include "net/serve/served_folder.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstdio>

namespace gs::app {
namespace {

struct WebType {
  std::string_view extensions, mime;
  bool compress;
};
constexpr WebType kWebTypes[] = {
    {".html .htm ", "text/html; charset=utf-8", true},
    {".css ", "text/css; charset=utf-8", true},
    {".js .mjs ", "text/javascript; charset=utf-8", true},
    {".json ", "application/json", true},
    {".txt .md .log ", "text/plain; charset=utf-8", true},
    {".csv ", "text/csv; charset=utf-8", true},
    {".xml ", "application/xml", true},
    {".svg ", "image/svg+xml", true},
    {".mtl ", "model/mtl", true},
    {".gltf ", "model/gltf+json", true},
    {".png ", "image/png", false},
    {".jpg .jpeg ", "image/jpeg", false},
    {".gif ", "image/gif", false},
    {".webp ", "image/webp", false},
    {".pdf ", "application/pdf", false},
    {".mp4 ", "video/mp4", false},
    {".webm ", "video/webm", false},
    {".mp3 ", "audio/mpeg", false},
    {".wav ", "audio/wav", false},
    {".wasm ", "application/wasm", true},
    {".zip ", "application/zip", false},
};
// Of our types, those that are mostly text.
constexpr std::string_view kTexts = ".wrl .vrml .obj .mgf .geom .geo .inp .ucd .xyz ";

// ".wrl " of "a.WRL"; empty where there is none.
std::string extension_of(std::string_view name) {
  const std::size_t point = name.rfind('.');
  if (point == std::string_view::npos || point + 1 == name.size() || point == 0) return {};
  return lower_case(name.substr(point)) + " ";
}

// Extensions begin with a point and end with a blank, so that no part of one is
// found.
bool lists(std::string_view extensions, const std::string& extension) {
  return !extension.empty() && extensions.find(extension) != std::string_view::npos;
}

std::string html(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

// A "./" before names keeps one with a colon from being taken for a URL.
std::string link(std::string_view name, bool folder) { return "./" + net::encode_name(name) + (folder ? "/" : ""); }

std::string json_page(const net::FolderListing& listing, bool made) {
  nlohmann::json entries = nlohmann::json::array();
  for (const net::FolderEntry& entry : listing.entries) {
    nlohmann::json one = {{"name", entry.name}, {"url", link(entry.name, entry.folder)}, {"folder", entry.folder}};
    one["modified"] = entry.modified;
    if (!entry.folder) {
      one["bytes"] = entry.size;
      one["type"] = served_type_of(entry.name).mime;
      if (made && content_type_by_name(entry.name)) one["thumbnail"] = link(entry.name, false) + "?thumbnail";
      if (made && can_be_encoded(entry.name)) one["qnv"] = link(entry.name + ".qnv", false);
    }
    entries.push_back(std::move(one));
  }
  const nlohmann::json page = {{"path", listing.path}, {"complete", listing.complete}, {"entries", entries}};
  return page.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

std::string html_row(const net::FolderEntry& entry, bool made) {
  const std::string url = link(entry.name, entry.folder);
  std::string row = "<tr><td>";
  if (made && !entry.folder && content_type_by_name(entry.name))
    row += "<a href=\"" + url + "\"><img src=\"" + url +
           "?thumbnail\" alt=\"\" loading=\"lazy\" width=\"160\" "
           "height=\"120\"></a>";
  row += "</td><td><a href=\"" + url + "\">" + html(entry.name) + (entry.folder ? "/" : "") + "</a>";
  if (made && !entry.folder && can_be_encoded(entry.name))
    row += " <a class=\"made\" href=\"" + link(entry.name + ".qnv", false) + "\">.qnv</a>";
  return row + "</td><td class=\"number\">" + (entry.folder ? std::string() : readable_size(entry.size)) + "</td><td>" +
         net::http_date(entry.modified) + "</td></tr>\n";
}

}  // namespace

const ContentType* content_type_by_name(std::string_view name) {
  std::string extension = extension_of(name);
  if (extension == ".gz ") extension = extension_of(name.substr(0, name.size() - 3));
  for (const ContentType& type : content_types())
    if (lists(type.extensions, extension)) return &type;
  return nullptr;
}

net::ServedType served_type_of(std::string_view name) {
  const std::string extension = extension_of(name);
  if (extension == ".gz ") return {"application/gzip", false};
  for (const WebType& type : kWebTypes)
    if (lists(type.extensions, extension)) return {std::string(type.mime), type.compress};
  if (const ContentType* type = content_type_by_name(name)) return {std::string(type->mime), lists(kTexts, extension)};
  return {};
}

bool can_be_encoded(std::string_view name) {
  const ContentType* type = content_type_by_name(name);
  return type && type->content != ContentClass::stream;
}

std::string readable_size(std::uint64_t bytes) {
  static constexpr std::array<const char*, 5> kUnits{"B", "kB", "MB", "GB", "TB"};
  auto value = static_cast<double>(bytes);
  std::size_t unit = 0;
  while (value >= 999.5 && unit + 1 < kUnits.size()) {
    value /= 1000;
    ++unit;
  }
  char text[32];
  std::snprintf(text, sizeof text, unit == 0 || value >= 99.95 ? "%.0f %s" : "%.1f %s", value, kUnits[unit]);
  return text;
}

net::FolderPage archive_index(const net::FolderListing& listing, bool json, bool made) {
  if (json) return {"application/json", json_page(listing, made)};
  const std::string title = html(listing.path);
  std::string page =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta "
      "charset=\"utf-8\"><title>" +
      title +
      "</title>\n<meta name=\"viewport\" "
      "content=\"width=device-width\">\n<style>\n"
      "body { font: 16px sans-serif; margin: 2em; color-scheme: light dark; }\n"
      "td { padding: 0.2em 0.8em; vertical-align: middle; }\n.number { "
      "text-align: right; }\n"
      ".made { font-size: 80%; }\nimg { display: block; background: #8884; "
      "}\n</style></head>\n<body><h1>" +
      title + "</h1>\n<table>\n";
  if (listing.path != "/") page += "<tr><td></td><td><a href=\"../\">..</a></td><td></td><td></td></tr>\n";
  for (const net::FolderEntry& entry : listing.entries) page += html_row(entry, made);
  page += "</table>\n";
  if (!listing.complete) page += "<p>There are more; they are not listed.</p>\n";
  page += "<p><a href=\"?json\">JSON</a></p></body></html>\n";
  return {"text/html; charset=utf-8", page};
}

}  // namespace gs::app
