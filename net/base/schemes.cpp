#include "net/base/schemes.h"

#include <algorithm>
#include <array>

namespace gs::net {
namespace {

constexpr std::array kSchemes{
    // name, transport, lane, from_network, redirect_target, cached, secure, has_host
    Scheme{"file", TransportKind::file, Lane::local, false, false, false, false, false},
    Scheme{"data", TransportKind::data, Lane::local, true, false, false, false, false},
    Scheme{"http", TransportKind::http, Lane::network, true, true, true, false, true},
    Scheme{"https", TransportKind::http, Lane::network, true, true, true, true, true},
    Scheme{"ftp", TransportKind::http, Lane::network, true, false, false, false, true},
    Scheme{"cells", TransportKind::cells, Lane::network, true, false, false, false, true},
    Scheme{"memory", TransportKind::memory, Lane::network, true, false, true, false, true},
};

}  // namespace

std::span<const Scheme> schemes() { return kSchemes; }

const Scheme* find_scheme(std::string_view name) {
  const auto found =
      std::find_if(kSchemes.begin(), kSchemes.end(), [name](const Scheme& scheme) { return scheme.name == name; });
  return found == kSchemes.end() ? nullptr : &*found;
}

std::string url_for_messages(std::string_view url) {
  constexpr std::size_t kLongest = 200;
  const std::size_t scheme_end = url.find(':');
  std::string result;
  if (scheme_end != std::string_view::npos && url.substr(scheme_end).starts_with("://")) {
    const std::size_t start = scheme_end + 3;
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
