// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/serve/live_page.h"

namespace todbench {

std::string_view live_html() {
  return R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>todbench</title>
<link rel="icon" href="data:,">
<link rel="stylesheet" href="live.css">
<script src="live.js" defer></script>
</head>
<body>
<header>
<h1 id="name">todbench</h1>
<p id="state" role="status"></p>
<p id="verdict" role="status"></p>
</header>
<main>
<p id="step" role="alert" hidden></p>
<p><span id="phase">waiting for the run</span> <span id="waiting"></span></p>
<progress id="progress" max="1" value="0" aria-label="Presentations"></progress>
<p id="count"></p>
<figure><img id="curve" alt="TOD curve so far" hidden></figure>
<figure><img id="picture" alt="Last picture of the camera" hidden></figure>
<p id="link"></p>
</main>
</body>
</html>
)";
}

std::string_view live_css() {
  return R"(:root { color-scheme: light dark; --ink: #1c1c1e; --ground: #ffffff; --muted: #55585e; --ask: #a83800; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e6e6e6; --ground: #1e1f22; --muted: #b0b3b8; --ask: #ff9a7a; }
}
body { margin: 0 auto; max-width: 62rem; padding: 0 1rem 2rem; font: 1rem/1.4 sans-serif; color: var(--ink); background: var(--ground); }
h1 { font-size: 1.4rem; overflow-wrap: anywhere; }
p { overflow-wrap: anywhere; }
#state { display: inline-block; margin: 0; padding: 0.2rem 0.8rem; border: 2px solid currentColor; border-radius: 0.4rem; font-weight: bold; }
#state:empty { display: none; }
#state.ask { color: var(--ask); }
#verdict { font-weight: bold; font-size: 1.2rem; }
#step { font-weight: bold; font-size: 1.6rem; color: var(--ask); white-space: pre-line; }
#waiting, #count, #link { color: var(--muted); }
progress { width: 100%; height: 1.2rem; }
figure { margin: 1rem 0; }
img { max-width: 100%; height: auto; display: block; background: #ffffff; }
img[hidden] { display: none; }
#picture { image-rendering: pixelated; width: 100%; max-width: 48rem; }
)";
}

std::string_view live_js() {
  return R"('use strict';
const part = (id) => document.getElementById(id);
let curve = 0, picture = 0, over = false;
const say = (id, text) => { if (part(id).textContent !== text) part(id).textContent = text; };
const words = {'running': 'running', 'settling': 'settling', 'plate-change': 'plate change', 'operator': 'operator needed',
  'camera-lost': 'camera lost, waiting for it to return', 'finished': 'finished', 'stopped': 'stopped'};
function show(state) {
  const word = words[state.state] || state.state;
  document.title = word + ' – ' + state.name + ' – todbench';
  say('name', state.name);
  say('state', word + (state.reason === null ? '' : ': ' + state.reason));
  part('state').className = ['operator', 'camera-lost', 'stopped'].includes(state.state) ? 'ask' : '';
  say('phase', state.phase);
  say('waiting', state.waiting);
  say('step', state.step);
  part('step').hidden = state.step === '';
  say('verdict', state.verdict === null ? '' : 'verdict: ' + state.verdict);
  part('progress').max = Math.max(1, state.planned);
  part('progress').value = state.done;
  say('count', state.planned > 0 ? state.done + ' of ' + state.planned + ' presentations' : '');
  if (state.curve !== curve) {
    curve = state.curve;
    part('curve').src = 'curve.svg?' + curve;
    part('curve').hidden = false;
  }
  if (state.picture !== picture) {
    picture = state.picture;
    part('picture').src = 'picture.png?' + picture;
    part('picture').hidden = false;
  }
  over = state.over;
}
async function look() {
  try {
    const answer = await fetch('state.json', {cache: 'no-store'});
    if (!answer.ok) throw new Error(String(answer.status));
    show(await answer.json());
    say('link', '');
  } catch (error) {
    say('link', over ? 'The run is finished and the program has ended.' : 'The program does not answer.');
    if (over) return;
  }
  setTimeout(look, 1000);
}
look();
)";
}

}  // namespace todbench
