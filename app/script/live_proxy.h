#pragma once

#include <js/Object.h>
#include <js/Proxy.h>
#include <jsfriendapi.h>

namespace gs::app::script {

/// What proxies for values of the world have in common: an ordinary prototype, properties that may come at any time,
/// and an end on the thread of the world.
class LiveProxyHandler : public js::BaseProxyHandler {
 public:
  explicit constexpr LiveProxyHandler(const void* family) : BaseProxyHandler(family) {}

  bool finalizeInBackground(const JS::Value&) const override { return false; }
  bool getPrototypeIfOrdinary(JSContext*, JS::HandleObject proxy, bool* is_ordinary,
                              JS::MutableHandleObject prototype) const override {
    *is_ordinary = true;
    prototype.set(js::GetStaticPrototype(proxy));
    return true;
  }
  bool preventExtensions(JSContext*, JS::HandleObject, JS::ObjectOpResult& result) const override {
    return result.failCantPreventExtensions();
  }
  bool isExtensible(JSContext*, JS::HandleObject, bool* extensible) const override {
    *extensible = true;
    return true;
  }
};

}  // namespace gs::app::script
