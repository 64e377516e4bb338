#pragma once

#include "app/loading/resources/resource_handler.h"

#include <optional>
#include <span>
#include <string>

namespace gs::app {

/// Content handler for a text of VRML or of a program (VRML97 4.12.1), optionally gzip-compressed.
class TextHandler final : public ResourceHandler {
 public:
  /// Creates a handler. The scene of `waits` is not handed over before the text is read; null if there is none.
  TextHandler(Loading& loading, const SceneHandler* waits, const UrlRequest& request)
      : ResourceHandler(loading, request), waits_for_(waits) {}

  [[nodiscard]] const SceneHandler* makes_nodes_of() const override { return waits_for_; }
  void receive(std::span<const std::byte> bytes) override;
  void end(const std::optional<std::string>& problem) override;
  void missing(const std::string& why) override;

 private:
  void give(std::optional<std::string> text);

  const SceneHandler* waits_for_;
  bool full_ = false;
};

}  // namespace gs::app
