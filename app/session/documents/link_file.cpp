#include "app/session/documents/link_file.h"

#include "base/text.h"
#include "net/base/schemes.h"
#include "net/base/url.h"
#include "net/files/file.h"

#include <algorithm>
#include <charconv>

namespace gs::app {
namespace {

constexpr std::string_view kLinkHead = "[GhostSpace link]";
constexpr std::size_t kMaxLink = 64 << 10, kMaxValue = 8 << 10;

std::string_view without_link_blanks(std::string_view text) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

bool has_controls(std::string_view text) {
  return std::any_of(text.begin(), text.end(),
                     [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; });
}

// Returns the reason why a link must not have this URL; nullopt if the URL is valid.
std::optional<std::string> refuse_place(std::string_view text) {
  if (text.size() > kMaxValue || has_controls(text))
    return "its URL is invalid; expected a URL of http, https or cells";
  const net::Url url = net::parse_url(std::string(text));
  const bool leads_on = url.scheme == "http" || url.scheme == "https" || url.scheme == "cells";
  if (leads_on && net::canonical_url(url)) return std::nullopt;
  return "it leads to '" + shortened(text, 80) + "'; expected a URL of http, https or cells";
}

}  // namespace

std::variant<SceneLink, std::string> read_link_file(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  if (text.size() > kMaxLink) return "the link exceeds 64 KiB";
  if (!text.starts_with(kLinkHead)) return "not a link: expected '" + std::string(kLinkHead) + "' on the first line";
  SceneLink link;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = without_link_blanks(text.substr(0, end));
    text.remove_prefix(std::min(text.size(), end + 1));
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos || line.starts_with('#')) continue;
    const std::string key = lower_case(without_link_blanks(line.substr(0, equals)));
    const std::string_view value = without_link_blanks(line.substr(equals + 1));
    if (key == "url") link.url = value;
    if (key == "viewpoint") link.viewpoint = value;
    if (key == "budget") {
      const auto [behind, error] = std::from_chars(value.data(), value.data() + value.size(), link.budget);
      if (error != std::errc() || behind != value.data() + value.size())
        return "its Budget is invalid; expected a whole number of vectors";
    }
  }
  if (link.url.empty()) return "the link has no URL; expected a line 'URL=http://...'";
  if (auto problem = refuse_place(link.url)) return std::move(*problem);
  if (link.viewpoint.size() > kMaxValue || has_controls(link.viewpoint))
    return "its Viewpoint is invalid; expected a name";
  return link;
}

std::string link_file_text(const SceneLink& link) {
  std::string text = std::string(kLinkHead) + "\nURL=" + link.url + "\n";
  if (!link.viewpoint.empty()) text += "Viewpoint=" + link.viewpoint + "\n";
  if (link.budget > 0) text += "Budget=" + std::to_string(link.budget) + "\n";
  return text;
}

std::optional<std::variant<SceneLink, std::string>> read_link_url(std::string_view url) {
  if (!net::has_scheme(url, kLinkScheme)) return std::nullopt;
  std::string place(url.substr(kLinkScheme.size() + 1));
  if (place.starts_with("//")) place = "http:" + place;
  // Accept "ghostspace:http//...": browsers that treat the URL as a path turn "ghostspace:http://..." into this.
  SceneLink link;
  if (const std::size_t mark = place.find('#'); mark != std::string::npos) {
    link.viewpoint = place.substr(mark + 1);
    place.resize(mark);
  }
  link.url = place;
  if (auto problem = refuse_place(link.url)) return std::variant<SceneLink, std::string>(std::move(*problem));
  if (has_controls(link.viewpoint))
    return std::variant<SceneLink, std::string>(std::string("its Viewpoint is invalid; expected a name"));
  return std::variant<SceneLink, std::string>(std::move(link));
}

std::optional<std::variant<SceneLink, std::string>> scene_link_of(const std::string& path_or_url) {
  if (auto link = read_link_url(path_or_url)) return link;
  std::string path = path_or_url;
  if (const net::Url url = net::parse_url(path_or_url); url.scheme == "file")
    path = net::path_of_url(url);
  else if (!url.scheme.empty() && net::find_scheme(url.scheme))
    return std::nullopt;
  if (!lower_case(path).ends_with(kLinkExtension)) return std::nullopt;
  const auto opened = net::open_file(path);
  if (const auto* problem = std::get_if<net::FileError>(&opened))
    return std::variant<SceneLink, std::string>(problem->message);
  const auto& file = std::get<net::RandomAccessFile>(opened);
  std::string text(static_cast<std::size_t>(std::min<std::uint64_t>(file.size(), kMaxLink + 1)), '\0');
  text.resize(file.read(0, std::as_writable_bytes(std::span(text))));
  return read_link_file(text);
}

}  // namespace gs::app
