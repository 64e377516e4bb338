#include "app/serve/archive_index.h"

#include "app/serve/index_rows.h"
#include "app/session/documents/link_file.h"
#include "base/text.h"
#include "net/serve/http_range.h"
#include "net/serve/served_folder.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <unordered_map>
#include <vector>

namespace gs::app {
namespace {

struct WebType {
  std::string_view extensions, mime;
  bool compress;
};
constexpr std::string_view kLinkWebExtension = ".gslink ";
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
    {kLinkWebExtension, kLinkMime, false},
};
// Extensions of content types that are mostly text.
constexpr std::string_view kTexts = ".wrl .vrml .obj .mgf .geom .geo .inp .ucd .xyz ";

// Returns the extension in lower case with a trailing blank: ".wrl " for "a.WRL". Returns "" if there is none.
std::string extension_of(std::string_view name) {
  const std::size_t point = name.rfind('.');
  if (point == std::string_view::npos || point + 1 == name.size() || point == 0) return {};
  return lower_case(name.substr(point)) + " ";
}

// Returns true if a list of extensions contains `extension`. Each extension begins with a point and ends with a blank,
// so that no part of an extension matches.
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

// Returns a relative link. The leading "./" is needed, because a name with a colon would be parsed as a URL.
std::string link(std::string_view name, bool folder) { return "./" + net::encode_name(name) + (folder ? "/" : ""); }

std::string json_page(const net::FolderListing& listing, bool made) {
  nlohmann::json entries = nlohmann::json::array();
  std::unordered_map<std::string, nlohmann::json> data;  // names of data files, by header
  for (const IndexRow& row : index_rows(listing.entries))
    for (const net::FolderEntry& part : row.data) data[row.entry.name].push_back(part.name);
  for (const net::FolderEntry& entry : listing.entries) {
    nlohmann::json one = {{"name", entry.name}, {"url", link(entry.name, entry.folder)}, {"folder", entry.folder}};
    one["modified"] = entry.modified;
    if (!entry.folder) {
      one["bytes"] = entry.size;
      one["type"] = served_type_of(entry.name).mime;
      if (const auto parts = data.find(entry.name); parts != data.end()) one["data"] = parts->second;
      if (made && content_type_by_name(entry.name)) one["thumbnail"] = link(entry.name, false) + "?thumbnail";
      if (made && can_be_encoded(entry.name)) one["qnv"] = link(entry.name + ".qnv", false);
    }
    entries.push_back(std::move(one));
  }
  const nlohmann::json page = {{"path", listing.path}, {"complete", listing.complete}, {"entries", entries}};
  return page.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

// Formats a date from year to minute, so that dates are easily compared. Uses UTC, because the time zone of the client
// is unknown.
std::string readable_date(std::int64_t unix_seconds) {
  const auto time = static_cast<std::time_t>(unix_seconds);
  std::tm parts{};
  if (!gmtime_r(&time, &parts)) return {};
  char text[64];
  std::snprintf(text, sizeof text, "%04d-%02d-%02d %02d:%02d UTC", parts.tm_year + 1900, parts.tm_mon + 1,
                parts.tm_mday, parts.tm_hour, parts.tm_min);
  return text;
}

// Returns the decoded value of a form field in a query such as "search=a+b%20c&sort=size".
std::string field_of(std::string_view query, std::string_view name) {
  while (!query.empty()) {
    const std::size_t end = std::min(query.find('&'), query.size());
    std::string_view part = query.substr(0, end);
    query.remove_prefix(std::min(query.size(), end + 1));
    if (!part.starts_with(name) || part.substr(name.size(), 1) != "=") continue;
    part.remove_prefix(name.size() + 1);
    std::string text;
    for (std::size_t i = 0; i < part.size(); ++i) {
      unsigned code = 0;
      const bool escaped =
          part[i] == '%' && i + 2 < part.size() &&
          std::from_chars(part.data() + i + 1, part.data() + i + 3, code, 16).ptr == part.data() + i + 3;
      text += escaped ? static_cast<char>(code) : part[i] == '+' ? ' ' : part[i];
      if (escaped) i += 2;
    }
    return text;
  }
  return {};
}

constexpr std::string_view kIndexStyle =
    ":root { color-scheme: light dark; --line: #8884; --quiet: #777; --accent: #3b82d6; }\n"
    "body { font: 15px/1.45 system-ui, sans-serif; margin: 0 auto; max-width: 70em; padding: 1em 1.5em 3em; }\n"
    "header { display: flex; flex-wrap: wrap; gap: 1em; align-items: baseline; justify-content: space-between; "
    "border-bottom: 1px solid var(--line); padding-bottom: 0.6em; }\n"
    "h1 { font-size: 1.3em; margin: 0; overflow-wrap: anywhere; }\nh1 a { text-decoration: none; }\n"
    "a { color: var(--accent); }\nsearch, form { display: flex; gap: 0.4em; }\n"
    "input, button { font: inherit; padding: 0.2em 0.6em; }\ntable { border-collapse: collapse; width: 100%; }\n"
    "th { text-align: left; font-weight: 600; white-space: nowrap; }\nth a { color: inherit; text-decoration: none; "
    "}\nth a:hover { text-decoration: underline; }\n"
    "th, td { padding: 0.35em 0.7em; border-bottom: 1px solid var(--line); vertical-align: middle; }\n"
    "td.picture { width: 112px; padding-left: 0; }\n.number { text-align: right; white-space: nowrap; }\n"
    "td.name { overflow-wrap: anywhere; }\n.more { font-size: 85%; }\n.more, footer { color: var(--quiet); }\n"
    "img { display: block; width: 112px; height: 84px; object-fit: cover; border-radius: 6px; background: var(--line); "
    "}\n"
    "tr:hover td { background: #8881; }\nfooter { margin-top: 1.5em; font-size: 85%; }\n";

// Returns the heading "FOLDER / a / b", with a link to each folder. `name` is the name of the served folder.
std::string path_heading(std::string_view path, const std::string& name) {
  std::vector<std::string> names;
  for (std::size_t begin = 1; begin < path.size();) {
    const std::size_t end = std::min(path.find('/', begin), path.size());
    names.emplace_back(path.substr(begin, end - begin));
    begin = end + 1;
  }
  std::string up, heading;
  for (std::size_t i = names.size(); i-- > 0;) {
    heading = " / <a href=\"" + (up.empty() ? "./" : up) + "\">" + html(names[i]) + "</a>" + heading;
    up += "../";
  }
  return "<a href=\"" + (up.empty() ? "./" : up) + "\">" + html(name) + "</a>" + heading;
}

std::string html_row(const IndexRow& shown, bool made) {
  const net::FolderEntry& entry = shown.entry;
  const std::string url = link(entry.name, entry.folder);
  const bool opens = !entry.folder && content_type_by_name(entry.name);
  const std::string scene = link((made ? streamed_name(entry.name) : entry.name) + std::string(kLinkExtension), false);
  const std::string target = opens ? scene : url;
  std::string row = "<tr><td class=\"picture\">";
  if (made && opens)
    row += "<a href=\"" + target + "\"><img src=\"" + url +
           "?thumbnail\" alt=\"\" loading=\"lazy\" width=\"112\" height=\"84\"></a>";
  row += "</td><td class=\"name\"><a href=\"" + target + "\">" + html(entry.name) + (entry.folder ? "/" : "") + "</a>";
  if (opens) {
    row += "<div class=\"more\"><a href=\"" + url + "\" download>file</a>";
    if (made && can_be_encoded(entry.name))
      row += " <a class=\"made\" href=\"" + link(entry.name + ".qnv", false) + "\" download>stream</a>";
    row += " " + html(content_type_by_name(entry.name)->name);
    for (const net::FolderEntry& part : shown.data)
      row += " + <a href=\"" + link(part.name, false) + "\" download>" + html(part.name) + "</a>";
    row += "</div>";
  }
  return row + "</td><td class=\"number\">" + (entry.folder ? std::string() : readable_size(entry.size)) +
         "</td><td class=\"number\">" + readable_date(entry.modified) + "</td></tr>\n";
}

/// Column by which the page of a folder can be sorted. Folders always precede files.
struct SortRow {
  std::string_view name, heading;
  bool (*before)(const net::FolderEntry& a, const net::FolderEntry& b);
};
constexpr SortRow kSorts[] = {
    {"name", "Name", [](const net::FolderEntry& a, const net::FolderEntry& b) { return a.name < b.name; }},
    {"size", "Size", [](const net::FolderEntry& a, const net::FolderEntry& b) { return a.size < b.size; }},
    {"date", "Date", [](const net::FolderEntry& a, const net::FolderEntry& b) { return a.modified < b.modified; }},
};

std::vector<IndexRow> chosen_rows(const net::FolderListing& listing, const std::string& search,
                                  const std::string& sort) {
  const std::string wanted = lower_case(search);
  const auto is_found = [&](const net::FolderEntry& entry) {
    return lower_case(entry.name).find(wanted) != std::string::npos;
  };
  std::vector<IndexRow> rows = index_rows(listing.entries);
  std::erase_if(rows, [&](const IndexRow& row) {
    return !is_found(row.entry) && std::none_of(row.data.begin(), row.data.end(), is_found);
  });
  const bool down = sort.starts_with('-');
  for (const SortRow& row : kSorts)
    if (row.name == std::string_view(sort).substr(down ? 1 : 0))
      std::stable_sort(rows.begin(), rows.end(), [&](const IndexRow& a, const IndexRow& b) {
        if (a.entry.folder != b.entry.folder) return a.entry.folder;
        return down ? row.before(b.entry, a.entry) : row.before(a.entry, b.entry);
      });
  return rows;
}

std::string form_text(std::string_view text) {
  std::string out;
  static constexpr char kDigits[] = "0123456789ABCDEF";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0)
      out += c;
    else
      out += {'%', kDigits[byte >> 4], kDigits[byte & 15]};
  }
  return out;
}

std::string column_heading(const SortRow& row, const std::string& search, const std::string& sort) {
  const bool down = sort == row.name;  // a click on the current column reverses its order
  const bool chosen = down || sort == "-" + std::string(row.name);
  std::string href = "?sort=" + std::string(down ? "-" : "") + std::string(row.name);
  if (!search.empty()) href += "&amp;search=" + form_text(search);
  return "<th" + std::string(row.name == "name" ? "" : " class=\"number\"") + "><a href=\"" + href + "\">" +
         std::string(row.heading) + (chosen ? (down ? " &#9650;" : " &#9660;") : "") + "</a></th>";
}

}  // namespace

net::ServedType served_type_of(std::string_view name) {
  const std::string extension = extension_of(name);
  if (extension == ".gz ") return {"application/gzip", false};
  for (const WebType& type : kWebTypes)
    if (lists(type.extensions, extension)) return {std::string(type.mime), type.compress};
  if (const ContentType* type = extension.empty() ? nullptr : content_type_by_name(name))
    return {std::string(type->mime), lists(kTexts, extension)};
  return {};
}

net::FolderPage archive_index(const net::FolderListing& listing, const net::FolderRequest& request, bool made,
                              const std::string& name) {
  if (request.json) return {"application/json", json_page(listing, made)};
  const std::string search = field_of(request.query, "search"), sort = field_of(request.query, "sort");
  const std::string known_sort = sort.size() <= 5 ? sort : std::string();
  std::string page = "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>" +
                     html(name + (listing.path == "/" ? "" : listing.path)) +
                     "</title>\n<meta name=\"viewport\" content=\"width=device-width\">\n<style>\n";
  page.append(kIndexStyle).append("</style></head>\n<body><header><h1>").append(path_heading(listing.path, name));
  page +=
      "</h1><form role=\"search\"><input type=\"search\" name=\"search\" placeholder=\"Search this folder\" value=\"" +
      html(search) + "\">";
  if (!known_sort.empty()) page += "<input type=\"hidden\" name=\"sort\" value=\"" + html(known_sort) + "\">";
  page += "<button>Search</button></form></header>\n<table>\n<tr><th></th>";
  for (const SortRow& row : kSorts) page += column_heading(row, search, known_sort);
  page += "</tr>\n";
  if (listing.path != "/")
    page += "<tr><td class=\"picture\"></td><td><a href=\"../\">..</a></td><td></td><td></td></tr>\n";
  const std::vector<IndexRow> rows = chosen_rows(listing, search, known_sort);
  std::uint64_t bytes = 0;
  for (const IndexRow& row : rows) {
    bytes += row.entry.folder ? 0 : row.entry.size;
    page += html_row(row, made);
  }
  page += "</table>\n";
  if (!listing.complete) page += "<p>More files exist; they are not listed.</p>\n";
  page += "<footer>" + std::to_string(rows.size()) + (rows.size() == 1 ? " entry, " : " entries, ") +
          readable_size(bytes) +
          ". Click a scene to open it in GhostSpace. <a href=\"?json\">JSON</a></footer></body></html>\n";
  return {"text/html; charset=utf-8", page};
}

std::optional<net::FolderPage> scene_link_page(const std::string& name, const net::FolderRequest& request, bool made) {
  if (!name.ends_with(kLinkExtension) || request.url.empty()) return std::nullopt;
  const std::string scene = name.substr(0, name.size() - kLinkExtension.size());
  const bool stream = made && scene.ends_with(".qnv") && can_be_encoded(scene.substr(0, scene.size() - 4));
  if (!stream && !content_type_by_name(scene)) return std::nullopt;
  SceneLink link;
  link.url = request.url + net::encode_name(scene);
  return net::FolderPage{std::string(kLinkMime), link_file_text(link)};
}

}  // namespace gs::app
