// Filters, order and enlargement of the contact sheet. Without it every photo is shown, the worst first.
(() => {
  const form = document.getElementById('filters'), sheet = document.getElementById('sheet');
  const big = document.getElementById('enlarged'), controls = [...form.querySelectorAll('select')];
  const cards = [...sheet.children];
  const turn = card => ['azimuth', 'pitch', 'distance'].map(k => Number(card.dataset[k]));
  const byDirection = (a, b) => {
    const [p, q] = [turn(a), turn(b)];
    return p[0] - q[0] || p[1] - q[1] || p[2] - q[2] || a.dataset.texture - b.dataset.texture;
  };
  const shown = () => [...sheet.children].filter(card => !card.hidden);

  function apply() {
    const chosen = controls.filter(c => c.value && c.name !== 'order');
    for (const card of cards) card.hidden = !chosen.every(c => card.dataset[c.name] === c.value);
    sheet.append(...(form.elements.order.value ? [...cards].sort(byDirection) : cards));
    const names = chosen.map(c => `, ${c.name} ${c.selectedOptions[0].text}`).join('');
    form.querySelector('output').value = `${shown().length} of ${cards.length} shown${names}`;
  }
  function read() {
    const wanted = new URLSearchParams(location.hash.slice(1));
    if (!controls.some(c => wanted.has(c.name))) return false;
    for (const c of controls) c.value = wanted.get(c.name) ?? '';
    apply();
    return true;
  }
  function enlarge(card) {
    if (!card) return;
    big.replaceChildren(...[...card.children].map(child => child.cloneNode(true)));
    big.card = card;
    if (!big.open) big.showModal();
  }

  form.hidden = false;
  form.addEventListener('change', () => {
    const kept = controls.filter(c => c.value).map(c => [c.name, c.value]);
    history.replaceState(null, '', '#' + new URLSearchParams(kept.length ? kept : [['order', '']]));
    apply();
  });
  addEventListener('hashchange', read);
  for (const card of cards) {
    card.tabIndex = 0;
    card.addEventListener('click', () => enlarge(card));
    card.addEventListener('keydown', e => { if (e.key === 'Enter') enlarge(card); });
  }
  big.addEventListener('click', () => big.close());
  big.addEventListener('keydown', e => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[e.key], all = shown();
    if (step) enlarge(all[all.indexOf(big.card) + step]);
  });
  if (!read()) {
    const detector = form.elements.detector;
    if (detector) detector.value = detector.options[1].value;
    apply();
  }
  const opened = new URLSearchParams(location.hash.slice(1)).get('enlarge');
  if (opened) enlarge(shown()[Number(opened)]);
})();
