// A value that is made on a thread of its own.
#pragma once

#include <functional>
#include <future>
#include <stop_token>
#include <utility>

namespace todbench {

/// Its destruction stops the making and waits for its end, so that what was lent to it may go afterwards.
template <typename T>
class Meanwhile {
 public:
  /// Begins. What `make` refers to outlives this.
  explicit Meanwhile(std::function<T(std::stop_token)> make)
      : made_(std::async(std::launch::async, std::move(make), halt_.get_token())) {}
  ~Meanwhile() { halt_.request_stop(); }
  Meanwhile(const Meanwhile&) = delete;
  Meanwhile& operator=(const Meanwhile&) = delete;

  /// Waits for it; a request to stop reaches its thread as well. Any thread, any number of times; lives as long as
  /// this.
  [[nodiscard]] const T& get(std::stop_token stop) {
    const std::stop_callback forward(std::move(stop), [this] { halt_.request_stop(); });
    const std::shared_future<T> made = made_;
    return made.get();
  }

 private:
  std::stop_source halt_;
  const std::shared_future<T> made_;  ///< last: its destructor waits
};

}  // namespace todbench
