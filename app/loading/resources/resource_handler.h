#pragma once

#include "app/loading/fetch/content_handler.h"
#include "app/loading/fetch/loading.h"
#include "app/loading/updates/missing_url.h"
#include "app/loading/updates/resource_updates.h"

#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace gs::app {

/// Content handler for the urls of a node, or of several nodes with these urls. Messages name the first node.
class ResourceHandler : public ContentHandler {
 public:
  ResourceHandler(Loading& loading, UrlRequest request)
      : loading_(loading), request_(std::move(request)), held_(loading.budget, Resource::files) {}
  bool begin(const Found& found) override {
    found_ = found;
    return true;
  }
  void missing(const std::string& why) override {
    if (!told) warn(": " + why_missing(request_.urls, why));
  }

 protected:
  /// Reports a warning of the form TYPE + `why`.
  void warn(const std::string& why) {
    loading_.results.report(Severity::warning, request_.file, request_.location, request_.type + why);
  }
  /// Keeps received bytes. Returns false if the memory budget refuses them.
  [[nodiscard]] bool keep(std::span<const std::byte> bytes) {
    if (!held_.grow(bytes.size())) return false;
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    return true;
  }
  void drop_bytes() {
    bytes_ = {};
    held_.shrink_to(0);
  }

  Loading& loading_;
  const UrlRequest request_;  // of the first node
  Found found_;
  std::vector<std::byte> bytes_;
  Share held_;  // of `bytes_`
};

}  // namespace gs::app
