#pragma once

#include <jsapi.h>

#include <exception>

namespace gs::app::script {

/// Calls a function for the engine. No exception may pass through the frames of the engine. Here it can only mean that
/// memory is exhausted, and becomes the engine's error for it.
template <class Function>
bool contain(JSContext* context, const Function& function) noexcept {
  try {
    return function();
  } catch (const std::exception&) {
    JS_ReportOutOfMemory(context);
    return false;
  }
}

/// Implementation of contained.
template <auto kFunction, class Type = decltype(kFunction)>
struct Contained;
template <auto kFunction, class... Parameters>
struct Contained<kFunction, bool (*)(JSContext*, Parameters...)> {
  static bool call(JSContext* context, Parameters... parameters) noexcept {
    return contain(context, [&] { return kFunction(context, parameters...); });
  }
};

/// A function that the engine calls, with the same parameters. Exceptions become errors of the engine.
template <auto kFunction>
inline constexpr auto contained = &Contained<kFunction>::call;

}  // namespace gs::app::script
