#pragma once

#include <functional>
#include <string>

#include "net/base/address_space.h"
#include "net/base/url.h"

namespace gs::net {

/// Lookup of an environment variable. Returns an empty string if it is not set.
using Environment = std::function<std::string(const std::string& name)>;

/// Returns the proxy for an http or https URL, or an empty string if no proxy applies. Reads http_proxy, https_proxy,
/// all_proxy and no_proxy as curl does. The program chooses the proxy itself, because behind a proxy it cannot check
/// the address of the host.
[[nodiscard]] std::string proxy_of(const Url& url, const Environment& environment);

/// Returns the proxy for a URL as the environment of this process states it.
[[nodiscard]] std::string proxy_of(const Url& url);

/// Returns the address space of a host that a proxy will resolve. Uses only the text of the host, such as "localhost"
/// or an address. For other names, the proxy must enforce the rules.
[[nodiscard]] AddressSpace space_by_name(const std::string& url, const AddressSpaceOf& space_of);

}  // namespace gs::net
