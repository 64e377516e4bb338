#include "net/http/http_proxy.h"

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <string_view>

#include "net/base/address_space.h"
#include "net/http/curl_library.h"

namespace gs::net {
namespace {

std::string lower_name(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return text;
}

std::string upper_name(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c; });
  return text;
}

/// Reports whether a host matches an element of a no_proxy list: a name, domain, address or block. Commas or blanks
/// separate the elements.
bool is_listed_host(const std::string& host, std::string_view list) {
  const auto address = ip_address_of(host);
  while (!list.empty()) {
    const std::size_t end = std::min(list.find_first_of(", \t"), list.size());
    std::string entry = lower_name(std::string(list.substr(0, end)));
    list.remove_prefix(std::min(end + 1, list.size()));
    if (entry.starts_with('.')) entry.erase(0, 1);
    if (entry.ends_with('.')) entry.pop_back();
    if (entry.empty()) continue;
    if (entry == "*") return true;
    if (address) {
      if (entry.size() > 2 && entry.front() == '[' && entry.back() == ']') entry = entry.substr(1, entry.size() - 2);
      const auto block = address_block_of(entry);
      if (block && block->contains(*address)) return true;
    } else if (host == entry || host.ends_with("." + entry)) {
      return true;
    }
  }
  return false;
}

struct FreeUrl {
  void operator()(CURLU* url) const { curl().curl_url_cleanup(url); }
};

}  // namespace

std::string proxy_of(const Url& url, const Environment& environment) {
  const auto place = host_and_port(url.authority);
  if (!place) return {};
  // Read http_proxy in lower case only: in a CGI program, HTTP_PROXY holds a header of the request.
  std::string proxy = environment(url.scheme + "_proxy");
  if (proxy.empty() && url.scheme != "http") proxy = environment(upper_name(url.scheme) + "_PROXY");
  if (proxy.empty()) proxy = environment("all_proxy");
  if (proxy.empty()) proxy = environment("ALL_PROXY");
  if (proxy.empty()) return {};
  std::string direct = environment("no_proxy");
  if (direct.empty()) direct = environment("NO_PROXY");
  std::string host = lower_name(place->host);
  if (host.ends_with('.')) host.pop_back();
  return is_listed_host(host, direct) ? std::string() : proxy;
}

std::string proxy_of(const Url& url) {
  return proxy_of(url, [](const std::string& name) {
    const char* const value = std::getenv(name.c_str());
    return std::string(value ? value : "");
  });
}

AddressSpace space_by_name(const std::string& url, const AddressSpaceOf& space_of) {
  if (!curl().problem.empty()) return AddressSpace::special;
  const std::unique_ptr<CURLU, FreeUrl> parts(curl().curl_url());
  char* text = nullptr;
  // curl normalises IPv4 addresses with octal or hexadecimal numbers.
  if (curl().curl_url_set(parts.get(), CURLUPART_URL, url.c_str(), 0) != CURLUE_OK ||
      curl().curl_url_get(parts.get(), CURLUPART_HOST, &text, CURLU_URLDECODE) != CURLUE_OK)
    return AddressSpace::special;
  std::string host = text;
  curl().curl_free(text);
  if (host.size() > 2 && host.front() == '[') host = host.substr(1, host.find(']') - 1);
  if (const auto address = ip_address_of(host)) return space_of(*address);
  if (host.ends_with('.')) host.pop_back();
  std::transform(host.begin(), host.end(), host.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return host == "localhost" || host.ends_with(".localhost") ? AddressSpace::loopback : AddressSpace::global;
}

}  // namespace gs::net
