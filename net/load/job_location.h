#pragma once

#include <optional>
#include <string>
#include <variant>

#include "net/base/schemes.h"
#include "net/base/url.h"
#include "net/transfer/load_types.h"

namespace gs::net {

/// Current URL of a request: the requested URL or the target of the last redirect. Checks both against the rules of
/// references. One thread.
class JobLocation {
 public:
  /// `options` and `request` must outlive the location.
  JobLocation(const LoaderOptions& options, const Request& request);

  /// Returns the canonical URL. Only data: URLs keep their fragments.
  [[nodiscard]] const std::string& url() const { return url_; }
  [[nodiscard]] const Scheme* scheme() const { return scheme_; }
  /// Returns the host that counts for max_transfers_per_host. Returns an empty string if there is no limit.
  [[nodiscard]] const std::string& host() const { return host_; }
  /// Returns the most private space from which responses are accepted.
  [[nodiscard]] AddressSpace reach() const { return reach_; }
  /// Refuses later responses from hosts in a space more private than `space`, because a name may later resolve to
  /// another address.
  void narrow_reach(AddressSpace space);
  /// Returns the reason why the request is invalid; nullopt if it is valid.
  [[nodiscard]] std::optional<std::string> invalid() const;
  /// Returns the error if the rules of references forbid the URL; nullopt if they allow it.
  [[nodiscard]] std::optional<LoadError> forbidden() const;
  /// Returns the target of a redirect by a host in `space`, or the reason why it must not be followed.
  [[nodiscard]] std::variant<Url, LoadError> redirect_target(const std::string& location, AddressSpace space);
  void redirect_to(const Url& target);
  /// Returns the beginning of an error message, with the URL and with the first URL after a redirect.
  [[nodiscard]] std::string failure_text() const;

 private:
  void set_url(std::string url);

  const LoaderOptions& options_;
  const Request& request_;
  std::string url_, host_;
  const Scheme* scheme_ = nullptr;
  AddressSpace reach_;
  unsigned redirects_ = 0;
};

}  // namespace gs::net
