#include "net/base/reference_policy.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "net/base/schemes.h"

namespace gs::net {
namespace {

namespace fs = std::filesystem;

/// First port that a reference may use. Lower ports belong to system services (RFC 6335): name servers, clocks, mail.
/// FTP is an exception.
constexpr std::uint16_t kFirstFreePort = 1024, kFtpPort = 21;

std::string known_schemes(bool from_network_only) {
  std::string result;
  for (const Scheme& scheme : schemes())
    if (scheme.transport != TransportKind::memory && (scheme.from_network || !from_network_only))
      result.append(result.empty() ? "" : ", ").append(scheme.name);
  return result;
}

/// Reference from a document to its folder.
constexpr std::string_view kThisFolder = "./";

bool has_password(const Url& url) { return url.authority.find('@') != std::string::npos; }

bool lies_in(const std::string& path, const std::string& folder) {
  if (!path.starts_with(folder)) return false;
  return path.size() == folder.size() || folder.ends_with('/') || path[folder.size()] == '/';
}

}  // namespace

std::string Origin::site() const {
  if (is_user()) return {};
  if (is_file()) return "file";
  const Url parts = parse_url(url);
  const auto canonical = canonical_url(parts);
  // A URL without a valid host has no site. Its whole text equals no site of other documents.
  if (!canonical) return url;
  return canonical->scheme + "://" + canonical->authority + " " + std::to_string(static_cast<int>(space));
}

AddressSpace Origin::reach() const {
  if (is_user()) return AddressSpace::special;
  // `special` addresses are not usable hosts, so no document may refer to them.
  return is_file() ? AddressSpace::loopback : std::max(space, AddressSpace::loopback);
}

void ReferencePolicy::allow(const std::string& path) {
  std::error_code error;
  const std::string real = fs::canonical(path, error).string();
  if (!error && std::find(allowed_.begin(), allowed_.end(), real) == allowed_.end()) allowed_.push_back(real);
}

void ReferencePolicy::allow_ssh(const Url& document) {
  if (const auto canonical = canonical_url(document))
    allowed_ssh_.push_back(resolve(*canonical, parse_url(kThisFolder)));
}

std::string ReferencePolicy::ssh_folder(const Origin& from, const Url& to) const {
  if (from.is_user()) return {};
  const auto target = canonical_url(resolve(Url{}, to));
  const auto holds = [&target](const Url& folder) {
    return target && folder.authority == target->authority && target->path.starts_with(folder.path);
  };
  const Url own = resolve(canonical_url(parse_url(from.url)).value_or(Url{}), parse_url(kThisFolder));
  // Prefer the larger folder of the opened world.
  for (const Url& folder : allowed_ssh_)
    if (folder.authority == own.authority && holds(folder)) return folder.path;
  return holds(own) ? own.path : std::string();
}

std::optional<ReferenceRefusal> ReferencePolicy::refuse_ssh(const Origin& from, const Url& to) const {
  if (!from.is_ssh()) return ReferenceRefusal{"only the user may open ssh: URLs; a document may not refer to them", {}};
  // The server refuses encoded slashes and dots, which could lead out of the folder.
  if (!ssh_folder(from, to).empty()) return std::nullopt;
  return ReferenceRefusal{"it lies outside of the world's folder on its host", {}};
}

std::optional<ReferenceRefusal> ReferencePolicy::refuse(const Origin& from, const Url& to) const {
  const Scheme* const target = find_scheme(to.scheme);
  if (!target) {
    if (to.scheme.empty()) return ReferenceRefusal{"it has no scheme; expected one of " + known_schemes(false), {}};
    return ReferenceRefusal{
        "the scheme " + to.scheme.substr(0, 32) + ": is not known; expected one of " + known_schemes(false), {}};
  }
  const auto named = canonical_url(to);
  // Refuse a URL without a host: other parsers, such as curl's, would take a host from its path.
  if (!named)
    return ReferenceRefusal{"it has no host or an invalid port; expected " + to.scheme + "://HOST:PORT/PATH", {}};
  if (from.is_user()) return std::nullopt;
  if (target->transport == TransportKind::file) return refuse_file(from, path_of_url(to));
  if (target->name == "ssh") return refuse_ssh(from, *named);
  Url own = parse_url(from.url);
  if (auto canonical = canonical_url(own)) own = std::move(*canonical);
  if (!from.is_file() && !target->from_network)
    return ReferenceRefusal{"a document of " +
                                (own.scheme.empty() ? "unknown origin" : own.scheme.substr(0, 32) + ":") +
                                " may not refer to " + to.scheme + ":; expected one of " + known_schemes(true),
                            {}};
  // A relative reference retains the user name and password of the base URL.
  const bool same_host = own.scheme == to.scheme && own.authority == named->authority;
  if (has_password(to) && !same_host)
    return ReferenceRefusal{"a document may not specify a user or password; expected " + to.scheme + "://HOST/PATH",
                            {}};
  const auto place = host_and_port(named->authority);
  if (target->transport == TransportKind::cells && place && place->port.value_or(kFirstFreePort) < kFirstFreePort)
    return ReferenceRefusal{"a document may not send datagrams to port " + std::to_string(*place->port) +
                                "; expected one from " + std::to_string(kFirstFreePort) + " on",
                            {}};
  if (target->name == "ftp" && place && place->port && *place->port < kFirstFreePort && *place->port != kFtpPort)
    return ReferenceRefusal{"a document may not send FTP commands to port " + std::to_string(*place->port) +
                                "; expected " + std::to_string(kFtpPort) + ", or one from " +
                                std::to_string(kFirstFreePort) + " on",
                            {}};
  const Scheme* const source = find_scheme(own.scheme);
  if (source && source->secure && target->has_host && !target->secure)
    return ReferenceRefusal{"a document of " + own.scheme + ": may not refer to " + to.scheme +
                                ":, which is not protected against changes in transit; expected " + own.scheme + ":",
                            {}};
  return std::nullopt;
}

std::optional<ReferenceRefusal> ReferencePolicy::refuse_file(const Origin& from, const std::string& path) const {
  if (from.is_user()) return std::nullopt;
  if (!from.is_file()) {
    const std::string scheme = parse_url(from.url).scheme;
    return ReferenceRefusal{"a document of " + (scheme.empty() ? "unknown origin" : scheme.substr(0, 32) + ":") +
                                " may not refer to file:; expected one of " + known_schemes(true),
                            {}};
  }
  std::error_code error;
  const fs::path real = fs::canonical(path, error);
  if (error) return std::nullopt;
  for (const std::string& folder : allowed_)
    if (lies_in(real.string(), folder)) return std::nullopt;
  const std::string folder = real.parent_path().string();
  return ReferenceRefusal{"it lies outside of the world's folder; --allow " + folder + " allows it", folder};
}

std::optional<std::string> refuse_host(AddressSpace reach, AddressSpace host, const std::string& address) {
  if (reaches(reach, host)) return std::nullopt;
  return (address.empty() ? "its address" : "the address " + address) + " is of " + std::string(name_of(host)) +
         "; a document of " + std::string(name_of(reach)) + " may not reach it";
}

std::string reference_of_path(std::string_view path) {
  constexpr std::string_view kPlain = "/-._~!$&'()*+,;=@";
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string result;
  for (const char c : path) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       kPlain.find(c) != std::string_view::npos;
    if (c == '\\')
      result += '/';
    else if (plain)
      result += c;
    else
      result.append("%").append(1, kDigits[byte >> 4]).append(1, kDigits[byte & 15]);
  }
  // Remove extra leading slashes: after two, a host name would follow.
  const std::size_t first = result.find_first_not_of('/');
  if (first != std::string::npos && first > 1) result.erase(0, first - 1);
  return result;
}

}  // namespace gs::net
