// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/report/html_style.h"

#include "bench/report/markup.h"

namespace todbench {

namespace {

/// Returns a CSS string in which every ASCII character except letters and digits is a numeric escape (CSS Syntax 3,
/// 4.3.7), so that no text ends the string or the style element.
std::string css_string(std::string_view plain) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string text = "\"";
  for (const char character : valid_text(plain)) {
    const auto byte = static_cast<unsigned char>(character);
    const bool harmless =
        byte >= 0x80U || (byte >= '0' && byte <= '9') || (byte >= 'A' && byte <= 'Z') || (byte >= 'a' && byte <= 'z');
    if (harmless) {
      text += character;
    } else {
      text.append({'\\', digits[byte >> 4U], digits[byte & 15U], ' '});
    }
  }
  return text + "\"";
}

}  // namespace

std::string page_style(std::string_view page_label) {
  // Text and badges have a contrast of at least 4.5 to 1 against their ground (WCAG 2.1) in both schemes. Paper is
  // always light.
  const std::string paper = "@page{@bottom-left{content:" + css_string(page_label) +
                            "}@bottom-right{content:\"Page \" counter(page) \" of \" counter(pages)}}\n";
  return paper +
         R"(:root{color-scheme:light dark;--page:#fff;--text:#1a1a1a;--soft:#595959;--rule:#c9c9c9;--head:#f1f3f5;--good:#00664a;
--bad:#a4262c;--open:#7a4b00;--good-ground:#e3f4ec;--bad-ground:#fbe6e6;--open-ground:#fbf0db}
@media screen and (prefers-color-scheme:dark){:root{--page:#101317;--text:#ececec;--soft:#b0b0b0;--rule:#3b424a;--head:#1b2026;
--good:#6fd6ae;--bad:#ff9c9c;--open:#f3c264;--good-ground:#11291f;--bad-ground:#351618;--open-ground:#302510}}
*{box-sizing:border-box}
body{margin:0 auto;padding:24px;max-width:1040px;background:var(--page);color:var(--text);
font:15px/1.45 system-ui,"DejaVu Sans",Arial,sans-serif}
h1{font-size:1.7em;margin:0 0 2px}
h2{font-size:1.2em;margin:30px 0 10px;padding-bottom:3px;border-bottom:1px solid var(--rule);break-after:avoid}
p{margin:8px 0}
.subtitle,.note,.why,figcaption{color:var(--soft)}
.note,figcaption{font-size:.87em}
.why{font-size:.9em}
.verdict{margin:16px 0;padding:12px 18px;border:2px solid;border-radius:6px;break-inside:avoid}
.verdict p{margin:3px 0;color:var(--text)}
.verdict .word{font-size:1.9em;font-weight:700;color:inherit}
.good{color:var(--good)}.bad{color:var(--bad)}.open{color:var(--open)}
.verdict.good{background:var(--good-ground)}.verdict.bad{background:var(--bad-ground)}.verdict.open{background:var(--open-ground)}
.badge{white-space:nowrap}
.imprint{display:flex;flex-wrap:wrap;gap:8px 18px;align-items:center;margin-bottom:14px;font-size:.9em}.imprint div{min-width:0;overflow-wrap:anywhere}.imprint img{max-width:100%;object-fit:contain;background:#fff}
.wide{overflow-x:auto}.short{break-inside:avoid}.unbroken{white-space:nowrap}
table{border-collapse:collapse;width:100%;margin:10px 0;font-size:.9em;font-variant-numeric:tabular-nums}
caption{text-align:left;font-weight:600;padding:4px 0}
th,td{padding:4px 9px;border-bottom:1px solid var(--rule);text-align:left;vertical-align:top}
thead th{background:var(--head);font-weight:600;vertical-align:bottom}
tbody th{font-weight:500}
tr,.values{break-inside:avoid}
.values th{width:38%;font-weight:500;color:var(--soft)}
.values td{overflow-wrap:anywhere}
.pairs{display:grid;grid-template-columns:repeat(2,minmax(0,1fr));gap:4px 28px;align-items:start}
figure{margin:10px 0;break-inside:avoid;display:flex;flex-direction:column}
figcaption{padding:4px 2px}
.pairs figure{flex-direction:column-reverse}
.pairs figcaption{font-weight:600;color:var(--text)}
ul{padding-left:22px}
.signatures{display:grid;grid-template-columns:repeat(3,1fr);gap:28px;break-inside:avoid}
.role{font-weight:600}
.line{border-bottom:1px solid var(--text);padding-top:14px;font-size:.9em;color:var(--soft)}
.line.tall{padding-top:34px}
@media (max-width:700px){.pairs,.signatures{grid-template-columns:1fr}}
@page{size:A4;margin:15mm 14mm 17mm;font:8pt "DejaVu Sans",Arial,sans-serif;color:#595959}
@media print{body{max-width:none;padding:0;font-size:9pt}h2{margin-top:20px}.wide{overflow:visible}.pairs{grid-template-columns:repeat(2,minmax(0,1fr))}
.signatures{grid-template-columns:repeat(3,1fr)}th,td{padding:2px 5px}*{print-color-adjust:exact;-webkit-print-color-adjust:exact}}
)";
}

}  // namespace todbench
