#include "net/base/host_names.h"

#include <algorithm>

namespace gs::net {
namespace {

// Returns true for "PORT" and for the empty text.
bool is_port(std::string_view text) {
  return text.size() <= 5 && std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

bool is_name_character(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || c == '-' || c == '.' || c == '_';
}

std::string_view trimmed_blanks(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

// Parses an address in the spelling of X-Forwarded-For, with or without brackets and port.
std::optional<IpAddress> forwarded_address(std::string_view text) {
  if (const auto plain = ip_address_of(std::string(text))) return plain;
  const auto host = host_of(text);
  return host ? ip_address_of(*host) : std::nullopt;
}

}  // namespace

bool is_loopback(const IpAddress& address) {
  static const AddressBlock four = *address_block_of("127.0.0.0/8"), six = *address_block_of("::1");
  return four.contains(address) || six.contains(address);
}

std::optional<std::string> host_of(std::string_view authority) {
  std::string_view host = authority, rest;
  if (authority.starts_with('[')) {
    const std::size_t end = authority.find(']');
    if (end == std::string_view::npos) return std::nullopt;
    host = authority.substr(1, end - 1);
    rest = authority.substr(end + 1);
    const auto address = host.find(':') != std::string_view::npos ? ip_address_of(std::string(host)) : std::nullopt;
    if (!address || (!rest.empty() && (rest.front() != ':' || !is_port(rest.substr(1))))) return std::nullopt;
    return address_text(*address);
  }
  const std::size_t colon = authority.find(':');
  if (colon != std::string_view::npos) {
    host = authority.substr(0, colon);
    if (!is_port(authority.substr(colon + 1))) return std::nullopt;
  }
  std::string name(host);
  for (char& c : name)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c + 32);
  if (name.ends_with('.')) name.pop_back();
  if (name.empty() || name.size() > 253 || !std::all_of(name.begin(), name.end(), is_name_character))
    return std::nullopt;
  return name;
}

HostNames::HostNames(const std::string& bind, const std::vector<std::string>& more)
    : own_{"localhost", "127.0.0.1", "::1"} {
  if (const auto address = ip_address_of(bind)) {
    own_.push_back(address_text(*address));
    checked_ = is_loopback(*address);
  }
  for (const std::string& name : more)
    if (const auto host = host_of(name.find(':') != std::string::npos && name.front() != '[' ? "[" + name + "]" : name))
      more_.push_back(*host);
  checked_ = checked_ || !more_.empty();
}

bool HostNames::is_own(std::string_view authority) const {
  const auto host = host_of(authority);
  return host && std::find(own_.begin(), own_.end(), *host) != own_.end();
}

bool HostNames::admits(std::string_view authority) const {
  if (!checked_ || is_own(authority)) return true;
  const auto host = host_of(authority);
  return host && std::find(more_.begin(), more_.end(), *host) != more_.end();
}

bool is_one_of(const std::vector<AddressBlock>& blocks, const IpAddress& address) {
  return std::any_of(blocks.begin(), blocks.end(), [&](const AddressBlock& block) { return block.contains(address); });
}

IpAddress client_of(const IpAddress& peer, std::string_view forwarded_for, const std::vector<AddressBlock>& proxies) {
  IpAddress client = peer;
  while (!forwarded_for.empty() && is_one_of(proxies, client)) {
    const std::size_t comma = forwarded_for.rfind(',');
    const std::size_t begin = comma == std::string_view::npos ? 0 : comma + 1;
    const auto before = forwarded_address(trimmed_blanks(forwarded_for.substr(begin)));
    if (!before) break;
    client = *before;
    forwarded_for = forwarded_for.substr(0, comma == std::string_view::npos ? 0 : comma);
  }
  return client;
}

}  // namespace gs::net
