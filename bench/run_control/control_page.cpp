// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/run_control/control_page.h"

namespace todbench {

std::string_view control_html() {
  return R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>todbench runs</title>
<link rel="icon" href="data:,">
<link rel="stylesheet" href="control.css">
<script src="control.js" defer></script>
</head>
<body>
<h1>todbench runs</h1>
<p id="link" role="status"></p>
<form id="access" hidden>
<label>Token <input id="token" autocomplete="off" spellcheck="false" size="34"></label> <button>Use the token</button>
</form>
<form id="start">
<p><label>Plan <select id="plan"><option value="">text below</option></select></label>
<label>Seed <input id="seed" inputmode="numeric" size="8"></label>
<label>Mode <select id="mode"><option value="">by the plan</option><option>measure</option><option>simulate</option></select></label></p>
<p><label for="toml">Text of a plan (TOML)</label><textarea id="toml" rows="6" spellcheck="false"></textarea></p>
<p><button type="button" id="check">Check the plan</button> <button>Start the run</button> <span id="said" role="status"></span></p>
</form>
<section id="question" role="alert" hidden>
<h2>The run needs the operator</h2>
<ul id="steps"></ul>
<p><button type="button" id="done">Done</button> <button type="button" id="refuse">Stop the run</button></p>
</section>
<section id="run" hidden>
<h2 id="name"></h2>
<p><b id="state"></b> <span id="phase"></span> <button type="button" id="stop">Stop</button></p>
<progress id="progress" max="1" value="0" aria-label="Presentations"></progress>
<p id="result"></p>
<table id="points" hidden><caption>Measured so far</caption><thead><tr><th>&Delta;T [K]</th><th>S75 [mrad]</th><th>95 %</th><th>trials</th></tr></thead><tbody></tbody></table>
<p id="files"></p>
<figure><img id="curve" alt="TOD curve so far" hidden></figure>
<figure><img id="picture" alt="Last picture of the camera" hidden></figure>
</section>
<h2>Runs</h2>
<table id="runs"><thead><tr><th>run</th><th>plan</th><th>mode</th><th>state</th><th>verdict</th></tr></thead><tbody></tbody></table>
</body>
</html>
)";
}

std::string_view control_css() {
  return R"(:root { color-scheme: light dark; --ink: #1c1c1e; --ground: #ffffff; --muted: #55585e; --ask: #a83800; --line: #8a8d93; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e6e6e6; --ground: #1e1f22; --muted: #b0b3b8; --ask: #ff9a7a; --line: #7c7f85; }
}
body { margin: 0 auto; max-width: 62rem; padding: 0 1rem 2rem; font: 1rem/1.4 sans-serif; color: var(--ink); background: var(--ground); }
h1 { font-size: 1.4rem; }
h2 { font-size: 1.15rem; overflow-wrap: anywhere; }
p, td { overflow-wrap: anywhere; }
label { margin-right: 1rem; }
textarea { display: block; width: 100%; box-sizing: border-box; font: 0.9rem monospace; }
input, select, button, textarea { font-size: 1rem; max-width: 100%; }
button { padding: 0.3rem 0.9rem; }
[hidden] { display: none; }
#question { border: 2px solid var(--ask); border-radius: 0.4rem; padding: 0 1rem; }
#question h2 { color: var(--ask); }
#link, #phase { color: var(--muted); }
progress { width: 100%; height: 1.2rem; }
table { border-collapse: collapse; margin: 0.6rem 0; }
caption { text-align: left; color: var(--muted); }
th, td { text-align: left; padding: 0.15rem 0.8rem 0.15rem 0; border-bottom: 1px solid var(--line); }
#points td { white-space: nowrap; }
figure { margin: 1rem 0; }
img { max-width: 100%; height: auto; display: block; background: #ffffff; }
#picture { image-rendering: pixelated; width: 100%; max-width: 40rem; }
)";
}

std::string_view control_js() {
  return R"('use strict';
const part = (id) => document.getElementById(id);
const say = (id, text) => { if (part(id).textContent !== text) part(id).textContent = text; };
let token = new URLSearchParams(location.hash.slice(1)).get('token') || sessionStorage.getItem('token') || '';
let shown = null, events = null, picture = '', asked = 0;
async function call(method, path, body) {
  const headers = {'Authorization': 'Bearer ' + token};
  if (body !== undefined) headers['Content-Type'] = 'application/json';
  const answer = await fetch('api/v1/' + path, {method, headers, cache: 'no-store', body: method === 'POST' ? JSON.stringify(body ?? {}) : undefined});
  const json = await answer.json();
  if (answer.status === 401) part('access').hidden = false;
  if (!answer.ok) throw new Error(json.error);
  return json;
}
const number = (value) => value === null ? '–' : Number(value).toPrecision(4);
function row(cells) {
  const tr = document.createElement('tr');
  for (const cell of cells) {
    const td = document.createElement('td');
    td.append(cell);
    tr.append(td);
  }
  return tr;
}
const file = (id, name) => {
  const a = document.createElement('a');
  a.href = 'api/v1/runs/' + id + '/files/' + name + '?token=' + encodeURIComponent(token);
  a.textContent = name;
  return a;
};
function show(run) {
  const live = run.live || {};
  part('run').hidden = false;
  say('name', 'Run ' + run.id + ': ' + run.name);
  say('state', run.state === 'running' ? live.state || 'running' : run.state);
  say('phase', run.over ? '' : [live.phase, live.waiting].filter(Boolean).join(', '));
  part('stop').hidden = run.over;
  part('progress').hidden = run.over;
  part('progress').max = Math.max(1, live.planned || 0);
  part('progress').value = live.done || 0;
  say('result', [run.verdict && 'verdict: ' + run.verdict, run.reason].filter(Boolean).join('; '));
  const points = run.points || [];
  part('points').hidden = points.length === 0;
  part('points').tBodies[0].replaceChildren(...points.map((p) => row([number(p.delta_t_k), number(p.s75_mrad),
    number(p.s75_ci95_mrad[0]) + ' … ' + number(p.s75_ci95_mrad[1]), String(p.trials)])));
  const question = run.question;
  part('question').hidden = question === null;
  if (question !== null) {
    asked = question.number;
    part('steps').replaceChildren(...question.steps.map((step) => {
      const li = document.createElement('li');
      li.textContent = step;
      return li;
    }));
  }
  part('files').replaceChildren();
  if (run.over && run.session) {
    for (const name of ['report.html', 'verdict.json', 'report.csv']) part('files').append(file(run.id, name), ' ');
  }
  const now = run.id + '/' + live.curve + '/' + live.picture;
  if (now !== picture) {
    picture = now;
    for (const [id, name, has] of [['curve', 'curve.svg', live.curve], ['picture', 'picture.png', live.picture]]) {
      part(id).hidden = !has;
      if (has) part(id).src = 'api/v1/runs/' + run.id + '/' + name + '?v=' + has + '&token=' + encodeURIComponent(token);
    }
  }
}
function follow(id) {
  shown = id;
  if (events !== null) events.close();
  events = new EventSource('api/v1/runs/' + id + '/events?token=' + encodeURIComponent(token));
  events.addEventListener('state', (event) => {
    const run = JSON.parse(event.data);
    show(run);
    if (run.over) {
      events.close();
      list();
    }
  });
}
async function list() {
  try {
    const {runs} = await call('GET', 'runs');
    part('runs').tBodies[0].replaceChildren(...runs.reverse().map((run) => {
      const button = document.createElement('button');
      button.textContent = run.id;
      button.addEventListener('click', () => follow(run.id));
      return row([button, run.name, run.mode, run.state, run.verdict || '–']);
    }));
    const running = runs.find((run) => run.state === 'running');
    if (shown === null && running) follow(running.id);
    say('link', '');
    part('access').hidden = true;
  } catch (error) {
    say('link', error instanceof TypeError ? 'The program does not answer.' : error.message);
  }
}
function asked_run() {
  const run = {};
  if (part('plan').value !== '') run.plan = part('plan').value;
  else run.plan_toml = part('toml').value;
  if (part('mode').value !== '') run.mode = part('mode').value;
  if (part('seed').value.trim() !== '') run.seed = Number(part('seed').value);
  return run;
}
async function trying(action) {
  try {
    say('said', await action());
  } catch (error) {
    say('said', error.message);
  }
}
part('start').addEventListener('submit', (event) => {
  event.preventDefault();
  trying(async () => {
    const run = await call('POST', 'runs', asked_run());
    follow(run.id);
    await list();
    return 'run ' + run.id + ' is ' + run.state;
  });
});
part('check').addEventListener('click', () => trying(async () => {
  const found = await call('POST', 'plans/check', asked_run());
  return found.valid ? 'The plan is valid: ' + found.mode + ', seed ' + found.seed : found.error;
}));
part('stop').addEventListener('click', () => trying(async () => { await call('POST', 'runs/' + shown + '/stop'); return 'stopping'; }));
for (const [id, answer] of [['done', 'done'], ['refuse', 'stop']]) {
  part(id).addEventListener('click', () => trying(async () => {
    await call('POST', 'runs/' + shown + '/answer', {answer, number: asked});
    return '';
  }));
}
async function begin() {
  sessionStorage.setItem('token', token);
  try {
    const {plans} = await call('GET', 'plans');
    part('plan').replaceChildren(part('plan').options[0], ...plans.map((name) => new Option(name, name)));
    if (plans.includes('demo')) part('plan').value = 'demo';
  } catch (error) {
    say('link', error.message);
    return;
  }
  await list();
}
part('access').addEventListener('submit', (event) => {
  event.preventDefault();
  token = part('token').value.trim();
  begin();
});
setInterval(list, 3000);
begin();
)";
}

}  // namespace todbench
