#pragma once

#include <functional>
#include <string>

#include "net/base/address_space.h"
#include "net/base/url.h"

namespace gs::net {

/// Returns the value of an environment variable; empty if it is not set.
using Environment = std::function<std::string(const std::string& name)>;

/// Returns the proxy for an http or https URL, or an empty string for none. Reads http_proxy, https_proxy, all_proxy
/// and no_proxy as curl does. It is decided here because a client of a proxy does not learn the address of the host.
[[nodiscard]] std::string proxy_of(const Url& url, const Environment& environment);

/// Returns the address space of a host that a proxy will resolve, as far as its name tells. For other names, the proxy
/// must enforce the rules.
[[nodiscard]] AddressSpace space_by_name(const std::string& url, const AddressSpaceOf& space_of);

}  // namespace gs::net
