// SPDX-License-Identifier: GPL-3.0-or-later
// Any text as the words of an instrument, as an answer of one, and as records of its remote procedure calls.
#include "bench/plan/instrument_description.h"
#include "tests/fuzz/fuzz_input.h"
#include "tod/instruments/onc_rpc.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace todbench;
  const std::string text(fuzz::text_of(data, size));
  (void)parse_instrument({.origin = "instrument.toml", .text = text});
  for (const auto* form : {"{}", "{},{}", "D={} mK"}) (void)numbers_in(text, form);
  std::string received = text;
  for (;;) {
    const auto record = take_rpc_record(received);
    if (!record || !*record) break;
    XdrReader reader(**record);
    (void)reader.number();
    (void)reader.bytes();
  }
  return 0;
}
