#include "net/base/schemes.h"

#include "net/base/url_signature.h"

#include <algorithm>
#include <array>

namespace gs::net {
namespace {

constexpr std::array kSchemes{
    // name, transport, lane, from_network, redirect_target, cached, buckets, secure, has_host, needs_host, port
    Scheme{"file", TransportKind::file, Lane::local, false, false, false, false, false, false, false, 0},
    Scheme{"data", TransportKind::data, Lane::local, true, false, false, false, false, false, false, 0},
    Scheme{"http", TransportKind::http, Lane::network, true, true, true, true, false, true, true, 80},
    Scheme{"https", TransportKind::http, Lane::network, true, true, true, true, true, true, true, 443},
    Scheme{"ftp", TransportKind::http, Lane::network, true, false, false, false, false, true, true, 21},
    Scheme{"ssh", TransportKind::http, Lane::network, false, false, true, false, true, true, true, 0},
    Scheme{"cells", TransportKind::cells, Lane::network, true, false, false, false, false, true, true, 0},
    Scheme{"memory", TransportKind::memory, Lane::network, true, false, true, true, false, true, false, 0},
};

}  // namespace

std::span<const Scheme> schemes() { return kSchemes; }

const Scheme* find_scheme(std::string_view name) {
  const auto found =
      std::find_if(kSchemes.begin(), kSchemes.end(), [name](const Scheme& scheme) { return scheme.name == name; });
  return found == kSchemes.end() ? nullptr : &*found;
}

std::optional<Url> canonical_url(Url url) {
  const Scheme* const scheme = find_scheme(url.scheme);
  if (!scheme || !scheme->needs_host) return url;
  const auto place = host_and_port(url.authority);
  if (!place) return std::nullopt;
  const std::size_t at = url.authority.rfind('@');
  std::string authority = at == std::string::npos ? std::string() : url.authority.substr(0, at + 1);
  const bool bracketed = url.authority.substr(authority.size()).starts_with('[');
  if (bracketed) authority += '[';
  // The configuration of ssh distinguishes upper and lower case in names of hosts.
  const bool folds = url.scheme != "ssh";
  for (const char c : place->host) authority += folds && c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  if (bracketed) authority += ']';
  if (place->port && *place->port != scheme->port) authority += ":" + std::to_string(*place->port);
  url.authority = std::move(authority);
  return url;
}

std::string url_for_messages(std::string_view given) {
  constexpr std::size_t kLongest = 200;
  const std::string unsigned_url = without_signature(given);
  std::string_view url = unsigned_url;
  const std::size_t scheme_end = url.find(':');
  std::string result;
  if (scheme_end != std::string_view::npos && url.substr(scheme_end).starts_with(":/") && !has_scheme(url, "file")) {
    // Some clients take a host, and a password, after any number of slashes.
    const std::size_t start = std::min(url.find_first_not_of('/', scheme_end + 1), url.size());
    const std::size_t end = std::min(url.find_first_of("/?#", start), url.size());
    const std::size_t at = url.substr(start, end - start).rfind('@');
    result = url.substr(0, start);
    url.remove_prefix(at == std::string_view::npos ? start : start + at + 1);
  }
  result.append(url.substr(0, kLongest + 1));
  const bool cut = result.size() > kLongest;
  if (cut) result.resize(kLongest);
  for (char& c : result)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  return cut ? result + "..." : result;
}

}  // namespace gs::net
