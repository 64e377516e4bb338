#pragma once

#include <functional>
#include <string>

#include "net/base/address_space.h"
#include "net/base/url.h"

namespace gs::net {

/// The value of a variable of the environment; empty: it is not set.
using Environment = std::function<std::string(const std::string& name)>;

/// The proxy through which a URL of http or https is to be had; empty: none. By http_proxy, https_proxy, all_proxy and
/// no_proxy, read as curl reads them; decided here because who asks a proxy does not learn the address of the host.
[[nodiscard]] std::string proxy_of(const Url& url, const Environment& environment);

/// Where a host is that a proxy will look up: what its name alone tells. Hosts whose names tell nothing are the
/// proxy's to refuse.
[[nodiscard]] AddressSpace space_by_name(const std::string& url, const AddressSpaceOf& space_of);

}  // namespace gs::net
