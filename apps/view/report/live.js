// Follows a run while it goes on: asks its server twice a second for what is new since the last answer, and draws
// that with the functions of page.js. At the end it fetches the report and shows it; then it needs the server no more.
'use strict';
const run_so_far = {frames: {index: [], ms: [], state: []}, estimate: [], truth: [], lost: [], loops: [],
                    points: {position: '', colour: ''}};
const between_polls = 500, between_points = 3000;  // milliseconds
let version = 0, failures = 0, points_due = 0, checked = false;

async function fetch_json(path) {
  const answer = await fetch(path);
  if (!answer.ok) throw new Error(`${path}: ${answer.status}`);
  return answer.json();
}

// Rows from `state.from` on replace what was known of them.
function take(state) {
  const {frames, estimate} = run_so_far, {index, ms, state: states, position} = state.rows;
  version = state.version;
  for (const [known, newer] of [[frames.index, index], [frames.ms, ms], [frames.state, states], [estimate, position]]) {
    known.length = state.from;
    for (const value of newer) known.push(value);
  }
  run_so_far.lost = frames.state.map((s, row) => s === 'tracking' ? -1 : row).filter(row => row >= 0);
  const row_of = new Map(frames.index.map((frame, row) => [frame, row]));
  run_so_far.loops = state.loops.map(pair => pair.map(frame => row_of.get(frame)));
}

function draw_live(state) {
  const {frames, estimate} = run_so_far, last = frames.index.length - 1;
  const done = state.total > 0 ? `${last + 1} of ${counted(state.total, 'frame')}` : counted(last + 1, 'frame');  // a stream's end is not known
  element('headline').textContent = state.finished ? 'finished' : `running: ${done}`;
  document.body.dataset.state = state.finished ? 'finished' : 'running';
  if (state.finished) element('now').querySelector('h2').textContent = 'Last frame';
  if (last < 0) return;
  show_tiles('now-tiles', [[frames.index[last], 'frame'], [frames.state[last], 'state'],
                           [fixed(frames.ms[last], 1) + ' ms', 'this frame'], [run_so_far.lost.length, 'frames lost'],
                           [state.keyframes, 'keyframes'], [state.loops.length, 'loops closed']]);
  element('now').dataset.drawn = last + 1;
  path_from_above(run_so_far);
  curve('time', frames.ms, 'milliseconds', css('estimate'));
  path_in_space(run_so_far);
  if (!checked) check_pictures();
  checked = true;
  const picture = element('picture');
  if (state.picture && picture.complete) picture.src = `image.jpg?version=${version}`;
}

async function follow() {
  try {
    const state = await fetch_json(`state.json?since=${version}`);
    take(state);
    if (!state.finished && run_so_far.estimate.length && Date.now() >= points_due) {
      run_so_far.points = await fetch_json('points.json');
      points_due = Date.now() + between_points;
    }
    draw_live(state);
    if (state.finished) {
      show_report(await fetch_json('report.json'));
      element('headline').textContent = 'finished: ' + element('headline').textContent;
      return;
    }
    failures = 0;
  } catch (error) {
    if (!(error instanceof TypeError)) complain(error.message);  // fetch() throws that where nobody answers
    if (++failures === 3) { complain('The program has ended; `penumbra report` shows its results.'); return; }
  }
  setTimeout(follow, between_polls);
}

for (const id of ['summary', 'error-section', 'filter-section', 'gallery-section', 'settings-section', 'stages']) show_section(id, false);
const legend = element('feature-legend').cloneNode(true);
legend.id = 'picture-legend';
element('picture-holder').append(legend);
element('picture').addEventListener('load', () => { element('picture-holder').hidden = false; });
follow();
