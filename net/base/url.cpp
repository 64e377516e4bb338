#include "net/base/url.h"

#include "net/base/hexadecimal.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <system_error>

namespace gs::net {
namespace {

constexpr std::string_view kHexadecimal = "0123456789ABCDEF";

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

void append_encoded(std::string& to, char c) {
  const auto byte = static_cast<unsigned char>(c);
  to += '%';
  to += kHexadecimal[byte >> 4];
  to += kHexadecimal[byte & 15];
}

std::string decoded(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%' && i + 2 < text.size()) {
      const int high = hexadecimal_value(text[i + 1]), low = hexadecimal_value(text[i + 2]);
      if (high >= 0 && low >= 0) {
        result += static_cast<char>(high * 16 + low);
        i += 2;
        continue;
      }
    }
    result += text[i];
  }
  return result;
}

/// Reports whether a path begins with a drive such as `C:`. A slash, a backslash or the end of the path must follow.
bool starts_with_drive(std::string_view path) {
  return path.size() >= 2 && is_letter(path[0]) && path[1] == ':' &&
         (path.size() == 2 || path[2] == '/' || path[2] == '\\');
}

std::size_t scheme_length(std::string_view text) {
  if (text.empty() || !is_letter(text[0])) return 0;
  std::size_t i = 1;
  while (i < text.size() &&
         (is_letter(text[i]) || is_digit(text[i]) || text[i] == '+' || text[i] == '-' || text[i] == '.'))
    ++i;
  return i < text.size() && text[i] == ':' && i > 1 ? i : 0;
}

/// Removes "." and ".." segments from a path (RFC 3986 5.2.4).
std::string remove_dot_segments(std::string_view input) {
  std::string output;
  const auto drop_last = [&output] {
    const std::size_t slash = output.rfind('/');
    output.erase(slash == std::string::npos ? 0 : slash);
  };
  while (!input.empty()) {
    if (input.starts_with("../")) {
      input.remove_prefix(3);
    } else if (input.starts_with("./") || input.starts_with("/./")) {
      input.remove_prefix(2);
    } else if (input == "/.") {
      input = "/";
    } else if (input.starts_with("/../")) {
      input.remove_prefix(3);
      drop_last();
    } else if (input == "/..") {
      input = "/";
      drop_last();
    } else if (input == "." || input == "..") {
      input = {};
    } else {
      const std::size_t end = std::min(input.find('/', 1), input.size());
      output += input.substr(0, end);
      input.remove_prefix(end);
    }
  }
  return output;
}

/// Joins a relative path to the path of a base URL (RFC 3986 5.2.3).
std::string merged(const Url& base, std::string_view path) {
  if (base.has_authority && base.path.empty()) return std::string("/").append(path);
  const std::size_t slash = base.path.rfind('/');
  return (slash == std::string::npos ? std::string() : base.path.substr(0, slash + 1)) + std::string(path);
}

}  // namespace

std::string Url::text() const {
  std::string result;
  if (!scheme.empty()) result.append(scheme).append(":");
  if (has_authority) result.append("//").append(authority);
  // If there is no authority, protect two leading slashes, which would begin an authority.
  else if (path.starts_with("//"))
    result += "/.";
  // Protect the first segment of a path, which could be taken for a scheme (RFC 3986 4.2).
  else if (scheme.empty() && scheme_length(path) > 0)
    result += "./";
  result += path;
  if (has_query) result.append("?").append(query);
  if (has_fragment) result.append("#").append(fragment);
  return result;
}

Url parse_url(std::string_view text) {
  Url url;
  if (const std::size_t length = scheme_length(text)) {
    url.scheme = text.substr(0, length);
    std::transform(url.scheme.begin(), url.scheme.end(), url.scheme.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    text.remove_prefix(length + 1);
  }
  if (const std::size_t hash = text.find('#'); hash != std::string_view::npos) {
    url.has_fragment = true;
    url.fragment = text.substr(hash + 1);
    text = text.substr(0, hash);
  }
  if (const std::size_t question = text.find('?'); question != std::string_view::npos) {
    url.has_query = true;
    url.query = text.substr(question + 1);
    text = text.substr(0, question);
  }
  if (text.starts_with("//")) {
    const std::size_t end = std::min(text.find('/', 2), text.size());
    url.has_authority = true;
    url.authority = text.substr(2, end - 2);
    text.remove_prefix(end);
  }
  url.path = text;
  return url;
}

bool has_scheme(std::string_view url, std::string_view scheme) {
  if (url.size() <= scheme.size() || url[scheme.size()] != ':') return false;
  return std::equal(scheme.begin(), scheme.end(), url.begin(),
                    [](char wanted, char c) { return wanted == (c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c); });
}

std::optional<HostAndPort> host_and_port(std::string_view authority) {
  if (const std::size_t at = authority.rfind('@'); at != std::string_view::npos) authority.remove_prefix(at + 1);
  HostAndPort result;
  std::string_view rest;
  if (authority.starts_with('[')) {
    const std::size_t end = authority.find(']');
    if (end == std::string_view::npos) return std::nullopt;
    result.host = authority.substr(1, end - 1);
    rest = authority.substr(end + 1);
  } else {
    const std::size_t end = std::min(authority.find(':'), authority.size());
    result.host = authority.substr(0, end);
    rest = authority.substr(end);
  }
  if (result.host.empty() || (!rest.empty() && rest.front() != ':')) return std::nullopt;
  if (rest.size() <= 1) return result;  // an empty port counts as missing (RFC 3986 3.2.3)
  std::uint16_t port = 0;
  const auto [end, error] = std::from_chars(rest.data() + 1, rest.data() + rest.size(), port);
  if (error != std::errc() || end != rest.data() + rest.size() || port == 0) return std::nullopt;
  result.port = port;
  return result;
}

Url resolve(const Url& base, const Url& reference) {
  // A path with a drive letter is absolute, although it looks relative. It becomes a file: URL.
  if (reference.scheme.empty() && !reference.has_authority && starts_with_drive(reference.path)) {
    Url result = reference;
    result.scheme = "file";
    result.has_authority = true;
    result.path = std::string("/").append(reference.path);
    std::replace(result.path.begin(), result.path.end(), '\\', '/');
    result.path = remove_dot_segments(result.path);
    return result;
  }
  Url result;
  result.has_fragment = reference.has_fragment;
  result.fragment = reference.fragment;
  if (!reference.scheme.empty() || reference.has_authority) {
    result.scheme = reference.scheme.empty() ? base.scheme : reference.scheme;
    result.has_authority = reference.has_authority;
    result.authority = reference.authority;
    result.path = remove_dot_segments(reference.path);
    result.has_query = reference.has_query;
    result.query = reference.query;
    return result;
  }
  result.scheme = base.scheme;
  result.has_authority = base.has_authority;
  result.authority = base.authority;
  if (reference.path.empty()) {
    result.path = base.path;
    result.has_query = reference.has_query || base.has_query;
    result.query = reference.has_query ? reference.query : base.query;
    return result;
  }
  result.path = remove_dot_segments(reference.path.front() == '/' ? reference.path : merged(base, reference.path));
  result.has_query = reference.has_query;
  result.query = reference.query;
  return result;
}

Url url_of_path(std::string_view path) {
  std::string whole(path);
  if (starts_with_drive(whole)) {
    std::replace(whole.begin(), whole.end(), '\\', '/');
    whole.insert(0, 1, '/');
  } else if (!whole.starts_with('/')) {
    std::error_code error;
    whole = std::filesystem::current_path(error).string();
    if (!whole.ends_with('/')) whole += '/';
    whole += path;
  }
  // Characters that need no encoding in a path segment (RFC 3986 3.3).
  constexpr std::string_view kPlain = "/-._~!$&'()*+,;=:@";
  // Keep `..`: the folder before it may be a link, which only the system can resolve.
  const bool climbs = (whole + "/").find("/../") != std::string::npos;
  Url result;
  result.scheme = "file";
  result.has_authority = true;
  for (const char c : climbs ? whole : remove_dot_segments(whole))
    if (is_letter(c) || is_digit(c) || kPlain.find(c) != std::string_view::npos)
      result.path += c;
    else
      append_encoded(result.path, c);
  return result;
}

std::string path_of_url(const Url& url) {
  if (url.scheme != "file") return {};
  std::string path = decoded(url.path);
  // Refuse a zero byte, at which the system would end the name.
  if (path.find('\0') != std::string::npos) return {};
  if (path.starts_with('/') && starts_with_drive(std::string_view(path).substr(1))) path.erase(0, 1);
  return path;
}

std::string tidy_url(std::string_view text) {
  const auto is_blank = [](char c) { return c == ' ' || (c >= '\t' && c <= '\r'); };
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  // Leave these URLs unchanged: they are program text or inline data, in which backslashes have a meaning.
  const std::string scheme = parse_url(text).scheme;
  const bool is_text = scheme == "javascript" || scheme == "vrmlscript" || scheme == "ecmascript" || scheme == "data";
  if (is_text) return std::string(text);
  std::string result;
  result.reserve(text.size());
  for (const char c : text) {
    if (c == '\\')
      result += '/';
    else if (is_blank(c))
      append_encoded(result, c);
    else
      result += c;
  }
  return result;
}

}  // namespace gs::net
