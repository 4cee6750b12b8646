function answer = webread (url)
  % What MATLAB's webread does with an answer in JSON; Octave's own leaves it as text.
  [status, text] = system (sprintf ("curl -sf '%s'", url));
  if (status != 0)
    error ("webread: curl ended with %d", status);
  end
  answer = jsondecode (text);
end
