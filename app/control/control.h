#pragma once

#include "app/control/control_channel.h"
#include "app/control/services.h"
#include "app/session/session.h"
#include "base/noncopyable.h"
#include "vrml/events/execution.h"

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gs::app {

/// Server of control clients for the worlds of a session. Offers the services of ISO/IEC 14772-2 as JSON-RPC 2.0
/// (docs/control.md). In each step, it acts after time has advanced and before the user's input. Session's thread.
class Control final : public SessionExtension, NonCopyable {
 public:
  /// Function that draws a view with a size in pixels. Returns a PNG file, or an error.
  using Painter =
      std::function<std::variant<std::vector<std::byte>, std::string>(const View& view, int width, int height)>;

  /// Creates the server on a channel, which must outlive it. The messages of a step are handled for at most
  /// `most_of_step`. If more messages wait then, `wake` requests another step at once.
  Control(ControlChannel& channel, std::function<void()> wake,
          std::chrono::steady_clock::duration most_of_step = std::chrono::milliseconds(10));
  ~Control() override;

  void set_painter(Painter painter) { painter_ = std::move(painter); }
  /// Returns true if a client has asked the program to end.
  [[nodiscard]] bool wants_to_end() const { return ends_; }

  bool act(Session& session) override;
  void step_is_over() override;

  // Functions for services.

  /// Returns the number with which a client refers to a node. The number keeps the node alive.
  [[nodiscard]] std::uint64_t number_of(ControlClient& client, vrml::SceneGraph& scene, vrml::NodeId node);
  void dispose(ControlClient& client, std::uint64_t node);
  [[nodiscard]] vrml::NodeId find_name(ControlClient& client, std::string_view name);
  [[nodiscard]] std::uint64_t watch(ControlClient& client, const PlacedNode& node,
                                    const vrml::InterfaceDeclaration& event);
  [[nodiscard]] bool unwatch(ControlClient& client, std::uint64_t watch);
  [[nodiscard]] const Painter& painter() const { return painter_; }
  void end() { ends_ = true; }
  /// Assigns a client to the world that its viewport shows now.
  void follow_viewport(Session& session, ControlClient& client);
  /// Sends the collected events. Any later message must follow them.
  void tell_events();

 private:
  void drop(ControlClient& client);
  void leave_world(ControlClient& client);
  void answer(Session& session, ControlClient& client, const std::string& message);
  void answer_call(Session& session, ControlClient& client, JsonCursor json, std::string& out);
  void tell_late();
  void note(ControlledWorld& world, const vrml::SentEvent& event);
  void tell_browser_event(ControlClient& client, std::string_view what, const Document* document);
  void observe(ControlledWorld& world);
  void prune();

  /// Event of a watch that is not sent yet.
  struct Seen {
    std::uint64_t client, watch;
    double time;
    vrml::FieldValue value;
  };
  void append_event(std::string& out, ControlClient& client, std::uint64_t number, const Watch& watch, double time,
                    const vrml::FieldValue& value, std::uint64_t missed);

  ControlChannel& channel_;
  std::function<void()> wake_;
  std::chrono::steady_clock::duration most_of_step_;
  Painter painter_;
  std::map<std::uint64_t, ControlClient> clients_;
  std::vector<std::unique_ptr<ControlledWorld>> worlds_;
  std::vector<Seen> seen_;
  bool changed_ = false, ends_ = false;
};

}  // namespace gs::app
